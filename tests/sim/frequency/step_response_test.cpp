/// Steps of an axis against closed forms and the table of checks of DOMAIN.md section 4.2.
#include "sim/frequency/step_response.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/frequency/stability.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"

namespace servomill::sim::frequency::step_response_test {
namespace {

enum class Preset { CC422, CC424 };

model::MachineSettings hsm600u(Preset preset) {
  model::MachineSettings machine =
      linearised(input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml"));
  if (preset == Preset::CC422) {
    machine.nc.periods.position = 180;
    machine.nc.periods.velocity = 60;
    for (auto& cascade : machine.nc.cascade) cascade.Tv = 0.6e-3;
  }
  return machine;
}

double overshoot(const model::MachineSettings& machine, int joint) {
  return step_response(machine, joint, 0, {StepKind::position, 1e-4, 0.15}, 1).figures.overshoot;
}

double load_peak(const model::MachineSettings& machine, int joint) {
  const double force = joint < kLinearJoints ? 500.0 : 50.0;  // N, N m
  return step_response(machine, joint, 0, {StepKind::load, force, 0.1}, 1).figures.peak;
}

// Table "Checks" of DOMAIN.md 4.2: X, Y, Z, B, C, each CC422 and CC424.
struct Checks {
  double overshoot[2];  // %, at Kv 83.3 1/s
  double Kv[2];         // 1/s, for 5 % overshoot
  double load[2];       // um, urad: peak after 500 N, 50 N m
};
constexpr std::array<Checks, kJoints> kTable = {{{{5.4, 2.4}, {83.0, 96.0}, {12.4, 11.6}},
                                                 {{5.0, 2.2}, {87.0, 96.0}, {13.2, 12.4}},
                                                 {{2.0, 0.1}, {96.0, 104.0}, {16.6, 15.7}},
                                                 {{0.0, 0.0}, {104.0, 117.0}, {70.0, 65.0}},
                                                 {{0.0, 0.0}, {104.0, 117.0}, {553.0, 515.0}}}};

// The table's numbers are those of a current command that acts at once (current period of a tick);
// a command that is one period of 0.1 ms old overshoots by up to 0.4 points, yields 1.6 % more.
TEST(StepResponse, IsThatOfTheDomainTable) {
  constexpr double kOvershootRounding = 0.1;  // %, points: two digits, and another step size
  constexpr double kLoadRounding = 0.01;
  constexpr double kOvershootOfDelay = 0.4;  // %, points
  constexpr double kLoadOfDelay = 0.02;
  constexpr double kTableGrid = 0.25 * 1000.0 / 60.0;  // 1/s: Kv in steps of 0.25 m/min/mm
  for (int joint = 0; joint < kJoints; ++joint) {
    const Checks& row = kTable[static_cast<std::size_t>(joint)];
    for (const Preset preset : {Preset::CC422, Preset::CC424}) {
      const auto column = static_cast<std::size_t>(preset);
      model::MachineSettings machine = hsm600u(preset);
      const double late = 100.0 * overshoot(machine, joint),
                   late_load = load_peak(machine, joint) / um;
      machine.nc.periods.current = 1;
      const double at_once = 100.0 * overshoot(machine, joint),
                   load = load_peak(machine, joint) / um;
      RecordProperty(fmt::format("{}_{}", joint, column),
                     fmt::format("{:.2f} % {:.2f} um, at once {:.2f} % {:.2f} um", late, late_load,
                                 at_once, load));
      EXPECT_NEAR(at_once, row.overshoot[column], kOvershootRounding) << joint;
      EXPECT_NEAR(load / row.load[column], 1.0, kLoadRounding) << joint;
      EXPECT_NEAR(late, row.overshoot[column], kOvershootOfDelay) << joint;
      EXPECT_NEAR(late_load / row.load[column], 1.0, kLoadOfDelay) << joint;

      double& Kv = machine.nc.cascade[static_cast<std::size_t>(joint)].Kv;
      const double on_grid = std::round(row.Kv[column] / kTableGrid) * kTableGrid;
      Kv = on_grid;
      EXPECT_GE(overshoot(machine, joint), 0.05) << joint << " Kv " << Kv;
      Kv = on_grid - kTableGrid;
      EXPECT_LT(100.0 * overshoot(machine, joint), 5.0 + kOvershootRounding) << joint;
    }
  }
}

// A damped oscillation: y = 1 - exp(-d t) (cos(w t) + d/w sin(w t)).
TEST(StepFigures, OfASecondOrderSystem) {
  const double d = 40.0, w = 120.0, h = 1e-5, height = -3e-3;
  std::vector<double> time, y;
  for (int n = 0; n < 30000; ++n) {
    const double t = h * n;
    time.push_back(t);
    y.push_back(height * (1.0 - std::exp(-d * t) * (std::cos(w * t) + d / w * std::sin(w * t))));
  }
  const StepFigures f = figures_of(StepKind::position, time, y, height, 0.02);
  EXPECT_NEAR(f.overshoot, std::exp(-d * std::numbers::pi / w), 1e-6);
  EXPECT_NEAR(f.peak_time, std::numbers::pi / w, h);
  EXPECT_NEAR(f.steady_error, height * std::exp(-d * 0.3), 1e-7);
  // the envelope reaches 2 % at ln(50 sqrt(1 + d^2/w^2)) / d; the oscillation within half a period
  const double envelope = std::log(50.0 * std::sqrt(1.0 + d * d / (w * w))) / d;
  EXPECT_LT(f.settling_time, envelope);
  EXPECT_GT(f.settling_time, envelope - std::numbers::pi / w);
  EXPECT_GT(f.rise_time, 0.0);
}

TEST(StepFigures, OfAFirstOrderSystem) {
  const double T = 0.012, h = 1e-5;
  std::vector<double> time, y;
  for (int n = 0; n < 20000; ++n) {
    time.push_back(h * n);
    y.push_back(1.0 - std::exp(-h * n / T));
  }
  const StepFigures f = figures_of(StepKind::velocity, time, y, 1.0, 0.02);
  EXPECT_EQ(f.overshoot, 0.0);
  EXPECT_NEAR(f.rise_time, T * std::log(9.0), 1e-6);
  EXPECT_NEAR(f.settling_time, T * std::log(50.0), h);
}

TEST(StepFigures, OfAnAxisThatDoesNotArriveAreNotNumbers) {
  const StepFigures f = figures_of(StepKind::position, {0.0, 1.0, 2.0}, {0.0, 0.4, 0.5}, 1.0, 0.02);
  EXPECT_TRUE(std::isnan(f.rise_time));
  EXPECT_TRUE(std::isnan(f.settling_time));
  EXPECT_EQ(f.steady_error, 0.5);
}

TEST(StepResponse, OfTheVelocityLoopSettlesOnItsCommand) {
  const model::MachineSettings machine = hsm600u(Preset::CC424);
  const StepResponse step = step_response(machine, 0, 0, {StepKind::velocity, 0.01, 0.4});
  constexpr double kIntegralTail = 1e-6;  // m/s, of 20 time constants of the reset
  EXPECT_NEAR(step.figures.steady_error, 0.0, kIntegralTail);
  EXPECT_GT(step.figures.overshoot, 0.05) << "the integral part overshoots";
  EXPECT_GT(step.peak_current, 0.0);
}

}  // namespace
}  // namespace servomill::sim::frequency::step_response_test
