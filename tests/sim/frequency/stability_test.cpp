#include "sim/frequency/stability.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::frequency::stability_test {
namespace {

model::MachineSettings hsm600u() {
  return input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml");
}

TEST(SpectralRadius, IsBelowOneForEveryAxisOfTheMachineFile) {
  const model::MachineSettings machine = hsm600u();
  for (int j = 0; j < kJoints; ++j) {
    for (const Tick delay : {0, 1}) {
      const double radius = spectral_radius(machine, j, delay);
      EXPECT_GT(radius, 0.9) << "the slowest mode of 0.2 ms is slow";
      EXPECT_LT(radius, 1.0) << machine.chain.layout.letter_of(j) << " delay " << delay;
    }
  }
}

// A position loop much slower than its velocity loop is first order: the slowest mode is
// exp(-Kv T).
TEST(SpectralRadius, OfALowGainIsThatOfAFirstOrderLoop) {
  model::MachineSettings machine = hsm600u();
  constexpr double kVelocityLoopShare =
      1e-3;  // a lag of the velocity loop of a millisecond at most
  machine.nc.cascade[0].Kv = 1.0;
  const double rate = -std::log(spectral_radius(machine, 0, 0)) / 0.2e-3;
  RecordProperty("rate", fmt::format("{:.6f}", rate));
  EXPECT_NEAR(rate, 1.0, kVelocityLoopShare);
}

double limit_of_Kv(model::MachineSettings machine, Tick delay) {
  double stable = 10.0, unstable = 5000.0;  // 1/s
  while (unstable - stable > 1e-6 * stable) {
    machine.nc.cascade[0].Kv = 0.5 * (stable + unstable);
    (spectral_radius(machine, 0, delay) < 1.0 ? stable : unstable) = machine.nc.cascade[0].Kv;
  }
  return stable;
}

TEST(SpectralRadius, FallsWithTheAgeOfTheReading) {
  const model::MachineSettings machine = hsm600u();
  const double fresh = limit_of_Kv(machine, 0), old = limit_of_Kv(machine, 19);
  RecordProperty("limit_Kv", fmt::format("{:.3f}", fresh));
  RecordProperty("limit_Kv_old_reading", fmt::format("{:.3f}", old));
  EXPECT_GT(fresh, machine.nc.cascade[0].Kv);
  EXPECT_LT(old, fresh);
}

// Growth of the following error of X a position period, from its largest values in two intervals
// after the end of a small move; encoders without steps, currents without limit.
double simulated_growth(double Kv) {
  const model::Scenario scenario = small_scenario(
      "G1 X0.01 F60\nM30\n",
      fmt::format("[machine_override.nc]\ncheck_stability = false\nfollowing_error_limit_mm = 1e6\n"
                  "[machine_override.axis.X]\nKv = \"{} 1/s\"\nscale_step = 0.0\nmotor_step = 0.0\n"
                  "i_max_A = 1e12\n"
                  "[record]\nperiod_ms = 0.2\nsettle_ms = 700.0\n[[case]]\nname = \"one\"\n",
                  Kv));
  const records::Series series = run_named_case(scenario, "one").result.servo;
  const std::size_t time = *series.column("time");
  const std::size_t error = *series.column("following_error_linear", 'X');
  const auto largest = [&](double from, double to) {
    double out = 0.0;
    for (std::size_t n = 0; n < series.rows(); ++n) {
      if (series.at(n, time) >= from && series.at(n, time) < to) {
        out = std::max(out, std::abs(series.at(n, error)));
      }
    }
    return out;
  };
  // after 0.3 s the slowest mode alone is left
  return std::pow(largest(0.6, 0.7) / largest(0.3, 0.4), 0.2e-3 / 0.3);
}

TEST(SpectralRadius, IsTheGrowthThatTheSimulationShows) {
  model::MachineSettings machine = hsm600u();
  const double limit = limit_of_Kv(machine, 0);
  for (const double factor : {0.9, 1.1}) {
    machine.nc.cascade[0].Kv = factor * limit;
    const double radius = spectral_radius(machine, 0, 0);
    const double simulated = simulated_growth(factor * limit);
    RecordProperty(fmt::format("radius_{}", factor), fmt::format("{:.8f}", radius));
    RecordProperty(fmt::format("simulated_{}", factor), fmt::format("{:.8f}", simulated));
    EXPECT_EQ(radius < 1.0, factor < 1.0);
    EXPECT_EQ(simulated < 1.0, factor < 1.0);
    // where in its period the largest sample lies changes the ratio by a few percent
    constexpr double kGrowthTol = 0.03;
    EXPECT_NEAR(std::log(simulated) / std::log(radius), 1.0, kGrowthTol) << factor;
  }
}

TEST(RunScenario, RefusesGainsThatDiverge) {
  const double limit = limit_of_Kv(hsm600u(), 0);
  const auto scenario = [&](double factor) {
    return small_scenario("G1 X1 F600\nM30\n",
                          fmt::format("[machine_override.axis.X]\nKv = \"{:.2f} 1/s\"\n[[case]]\n"
                                      "name = \"one\"\n",
                                      factor * limit));
  };
  EXPECT_NO_THROW(run::check_scenario(scenario(0.99)));
  EXPECT_THROW(run::check_scenario(scenario(1.01)), InputError);
}

}  // namespace
}  // namespace servomill::sim::frequency::stability_test
