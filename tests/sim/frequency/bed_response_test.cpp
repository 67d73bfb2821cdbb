/// Loops of an axis on a bed that its drive pushes back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/frequency/axis_dynamics.h"
#include "sim/frequency/bode.h"
#include "sim/frequency/frequency_response.h"
#include "sim/frequency/stability.h"
#include "sim/frequency/step_response.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"

namespace servomill::sim::frequency::bed_response_test {
namespace {

constexpr int kY = 1;
constexpr double kBed = 18.0;  // Hz
constexpr Complex kJ{0.0, 1.0};

model::MachineSettings fixed() {
  return input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml");
}

model::MachineSettings on_bed(double f = kBed, double zeta = 0.04, double M = 3000.0) {
  model::MachineSettings machine = fixed();
  machine.drives[kY].bed = {M, 2.0 * std::numbers::pi * f, zeta};
  return machine;
}

// Motor speed per current: motor, screw, and a slide on a bed (SI).
Complex motor_slide_and_bed(const plant::FeedDriveParams& p, Complex s) {
  const Complex mounts = 2.0 * p.bed.zeta * p.bed.w * s + p.bed.w * p.bed.w;
  const double mu = p.M * p.bed.M / (p.M + p.bed.M), ratio = (p.M + p.bed.M) / p.bed.M;
  const Complex slide = mu * s * (s * s + ratio * mounts) / (s * s + mounts) + p.b_load;
  const Complex link = p.c + p.k / s;
  return p.Kt / (p.J * s + p.b_motor + p.r * p.r * link * slide / (link + slide));
}

TEST(BedResponse, of_the_drive_is_the_closed_form) {
  const model::MachineSettings machine = on_bed();
  FrequencyResponse response(machine, kY, 0, PositionLoop::closed);
  constexpr double kFolding = 0.1;  // of f h: harmonics of the held current
  for (const double f : logarithmic(1.0, 1000.0, 50)) {
    const Complex exact =
        ratio(response.at(Entry::setpoint, f), AxisSignal::motor_speed, AxisSignal::current);
    const Complex closed = motor_slide_and_bed(machine.drives[kY], kJ * 2.0 * std::numbers::pi * f);
    EXPECT_LT(std::abs(exact / closed - 1.0), kFolding * f * machine.nc.periods.base) << f;
  }
}

// A slide whose drive is soft against its servo: the anti-resonance at the bed's frequency.
TEST(BedResponse, has_its_zero_at_the_frequency_of_the_bed) {
  model::MachineSettings machine = on_bed(kBed, 0.001);
  machine.drives[kY].b_load = machine.drives[kY].b_motor = 0.0;
  FrequencyResponse response(machine, kY, 0, PositionLoop::open);
  double least = 1e300, at = 0.0;
  for (const double f : logarithmic(10.0, 30.0, 2000)) {
    const double y = std::abs(
        ratio(response.at(Entry::velocity_command, f), AxisSignal::velocity, AxisSignal::current));
    if (y < least) {
      least = y;
      at = f;
    }
  }
  EXPECT_NEAR(at, kBed, 0.02);
  const auto [zero, pole] = bed_frequencies(machine.drives[kY]);
  EXPECT_NEAR(zero, kBed, 1e-12);
  const double m = machine.drives[kY].M;
  EXPECT_NEAR(pole, kBed * std::sqrt((m + 3000.0) / 3000.0), 1e-9);
  EXPECT_EQ(bed_frequencies(fixed().drives[kY])[0], 0.0);
}

TEST(BedResponse, is_that_of_a_fixed_bed_where_the_bed_is_stiff) {
  FrequencyResponse stiff(on_bed(4000.0, 0.1), kY, 0, PositionLoop::closed);
  FrequencyResponse without(fixed(), kY, 0, PositionLoop::closed);
  for (const double f : logarithmic(1.0, 100.0, 10)) {
    const Complex a = stiff.at(Entry::setpoint, f)[index_of(AxisSignal::position)];
    const Complex b = without.at(Entry::setpoint, f)[index_of(AxisSignal::position)];
    EXPECT_LT(std::abs(a / b - 1.0), 2.0 * std::pow(f / 4000.0, 2.0) + 1e-5) << f;
  }
}

// The position loop sees the bed: bode draws its peak, and looks where it is.
TEST(BedResponse, is_in_the_curves_and_margins_of_bode) {
  const auto curve_of = [](const model::MachineSettings& machine) {
    BodeSettings settings;
    settings.measure = false;
    return bode(machine, kY, 0, settings);
  };
  const BodeResult bed = curve_of(on_bed(kBed, 0.005)), without = curve_of(fixed());
  EXPECT_TRUE(bed.stable);
  double change = 0.0, at = 0.0;
  const Curve& open = bed.curves[0].exact;
  for (std::size_t n = 1; n < open.f.size(); ++n) {
    const double turn = std::abs(std::log(open.y[n] / open.y[n - 1]));
    if (turn > change) {
      change = turn;
      at = open.f[n];
    }
  }
  EXPECT_NEAR(at, kBed, 1.5);
  EXPECT_NE(bed.margins.phase, without.margins.phase);
  EXPECT_GT(bed.time_constant, 3.0 * without.time_constant);  // it rings longer
  EXPECT_LT(spectral_radius(on_bed(kBed, 0.005), kY, 0), 1.0);
}

// A stiff servo holds the slide on the bed, which then swings at its own frequency and damping.
TEST(BedResponse, rings_after_a_step_at_the_frequency_of_the_bed) {
  const model::MachineSettings machine = linearised(on_bed(kBed, 0.01));
  const StepResponse step = step_response(machine, kY, 0, {StepKind::position, 1e-4, 0.8}, 1);
  std::vector<double> crossings;
  for (std::size_t n = 1; n < step.time.size(); ++n) {
    if (step.time[n] < 0.3) continue;
    const auto away = [&](std::size_t k) {
      return step.signals[k][index_of(AxisSignal::position)] - 1e-4;
    };
    if (away(n - 1) < 0.0 && away(n) >= 0.0) crossings.push_back(step.time[n]);
  }
  ASSERT_GE(crossings.size(), 5U);
  const double period =
      (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  EXPECT_NEAR(1.0 / period, kBed, 0.05 * kBed);
}

}  // namespace
}  // namespace servomill::sim::frequency::bed_response_test
