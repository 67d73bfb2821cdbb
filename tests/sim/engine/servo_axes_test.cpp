/// Axes with their loops, as a case has them: where they begin, and what counts as an error.
#include "sim/engine/servo_axes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::servo_axes_test {
namespace {

constexpr double kStandTol = 1e-6;  // um, of an axis that stands where a formula says
constexpr const char* kStand = "G4 P0.05\nG1 X0.001 F60\nM30\n";  // Y and Z only stand

const std::string kIdealEncoders =
    "[machine_override.axis]\nX.motor_step = 0.0\nY.motor_step = 0.0\nZ.motor_step = 0.0\n"
    "X.scale_step = 0.0\nY.scale_step = 0.0\nZ.scale_step = 0.0\n";

// Largest and smallest following error of an axis in um.
std::pair<double, double> following_error(const model::Scenario& scenario, char axis) {
  const run::CaseOutput out = run_named_case(scenario, "alone");
  const records::Series& series = out.result.servo;
  const std::size_t column = series.column("following_error_linear", axis).value();
  double low = series.at(0, column), high = low;
  for (std::size_t n = 0; n < series.rows(); ++n) {
    low = std::min(low, series.at(n, column));
    high = std::max(high, series.at(n, column));
  }
  return {low, high};
}

model::Scenario standing(const std::string& axis_keys) {
  return small_scenario(kStand, kIdealEncoders + axis_keys + "[[case]]\nname = \"alone\"\n");
}

TEST(ServoAxes, BeginWhereAnIntegralPartHoldsTheLoad) {
  const auto [low, high] = following_error(standing("Z.gravity_load = \"2000 N\"\n"), 'Z');
  EXPECT_NEAR(low, 0.0, kStandTol);
  EXPECT_NEAR(high, 0.0, kStandTol);
}

TEST(ServoAxes, DroopUnderLoadWithoutAnIntegralPart) {
  // F r^2 / (Kp Kv)
  constexpr double kForce = 2000.0,
                   kKp = 220.0 * (8.0e-3 + 300.0 * 3.1830988618e-3 * 3.1830988618e-3);
  constexpr double r = 3.1830988618e-3, Kv = 500.0 / 6.0;
  const auto [low, high] = following_error(
      standing("Z.velocity_reset_time_ms = 0.0\nZ.gravity_load = \"2000 N\"\n"), 'Z');
  const double droop = kForce * r * r / (kKp * Kv) * 1e6;
  EXPECT_NEAR(low, droop, 1e-6 * droop);
  EXPECT_NEAR(high, droop, 1e-6 * droop);
}

TEST(ServoAxes, DroopMoreUnderACurrentLoopWithoutOne) {
  // the command is ahead of the current by R i / (L bandwidth)
  const std::string winding =
      "Z.current_loop = \"pi\"\nZ.winding = { inductance = \"4 mH\", resistance = \"0.6 ohm\", "
      "bandwidth = \"3000 rad/s\", reset_time_ms = 0.0 }\n";
  const auto droop = [&](const std::string& more) {
    const auto [low, high] = following_error(
        standing("Z.velocity_reset_time_ms = 0.0\nZ.gravity_load = \"2000 N\"\n" + more), 'Z');
    EXPECT_NEAR(low, high, 1e-6 * high);
    return high;
  };
  EXPECT_NEAR(droop(winding) / droop(""), 1.0 + 0.6 / (4e-3 * 3000.0), 1e-6);
}

TEST(ServoAxes, CountACompensatedGapAsNoFollowingError) {
  const std::string program = "G1 X5 F1000\nG4 P0.3\nG1 X3\nG4 P0.3\nM30\n";
  const std::string toml =
      kIdealEncoders +
      "X.position_feedback = \"motor\"\nX.backlash = \"10 um\"\n"
      "X.backlash_compensation = { width = \"10 um\" }\n"
      "X.standstill_limit = \"1 um\"\nX.standstill_delay_ms = 200.0\n[[case]]\nname = \"alone\"\n";
  EXPECT_TRUE(run_named_case(small_scenario(program, toml), "alone").result.outcome.finished);
}

TEST(ServoAxes, RunUnderCvodeWhatTheExactStepRefuses) {
  const auto with = [](const std::string& integrator) {
    return small_scenario("G1 X0.01 F100\nM30\n",
                          "[machine_override]\nintegrator = \"" + integrator +
                              "\"\n[machine_override.axis.X.friction]\nmodel = \"lugre\"\n"
                              "bristle_stiffness = \"1e15 N/m\"\n[[case]]\nname = \"alone\"\n");
  };
  EXPECT_THROW(with("exact"), InputError);
  EXPECT_TRUE(run_named_case(with("cvode"), "alone").result.outcome.finished);
}

TEST(ServoAxes, TakeALinearDriveHoweverStiff) {
  EXPECT_NO_THROW(standing("X.damping = \"1e12 N s/m\"\n"));
}

}  // namespace
}  // namespace servomill::sim::engine::servo_axes_test
