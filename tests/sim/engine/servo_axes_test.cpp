/// Axes with their loops, as a case has them: where they begin, and what counts as an error.
#include "sim/engine/servo_axes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "tests/sim/small_scenario.h"

namespace servomill::sim::servo_axes_test {
namespace {

constexpr double kStandTol = 1e-6;  // um, of an axis that stands where a formula says
constexpr const char* kStand = "G4 P0.05\nG1 X0.001 F60\nM30\n";  // Y and Z only stand

const std::string kIdealEncoders =
    "[machine_override.axis]\nX.motor_step = 0.0\nY.motor_step = 0.0\nZ.motor_step = 0.0\n"
    "X.scale_step = 0.0\nY.scale_step = 0.0\nZ.scale_step = 0.0\n";

// Largest and smallest following error of an axis in um.
std::pair<double, double> following_error(const Scenario& scenario, char axis) {
  const CaseOutput out = run_case(scenario, "alone");
  const Series& series = out.result.servo;
  const std::size_t column = series.column("following_error_linear", axis).value();
  double low = series.at(0, column), high = low;
  for (std::size_t n = 0; n < series.rows(); ++n) {
    low = std::min(low, series.at(n, column));
    high = std::max(high, series.at(n, column));
  }
  return {low, high};
}

Scenario standing(const std::string& axis_keys) {
  return small_scenario(kStand, kIdealEncoders + axis_keys + "[[case]]\nname = \"alone\"\n");
}

// Instants at which the error model is due every `model` ticks, the current loop every `current`.
std::vector<Instant> schedule_of(Tick current, Tick model) {
  return make_schedule({{kCurrentLoop, current, 0}, {kErrorModel, model, 0}});
}

TEST(DriveWay, LeadsPastInstantsOfTheErrorModelAlone) {
  const DriveWay way = drive_way(schedule_of(10, 6));  // 0 6 10 12 18 20 24 (30)
  const std::vector<plant::Stretch> wanted = {{10, {6}}, {10, {2, 8}}, {10, {4}}};
  EXPECT_EQ(way.stretches, wanted);
  EXPECT_TRUE(way.steps.empty());
  EXPECT_EQ(way.most_stops, 2U);
  const std::vector<std::pair<Tick, int>> legs = {{10, 0}, {10, 1}, {10, 2}};
  ASSERT_EQ(way.legs.size(), legs.size());
  for (std::size_t n = 0; n < legs.size(); ++n) {
    EXPECT_EQ(std::pair(way.legs[n].step, way.legs[n].stretch), legs[n]) << n;
  }
}

TEST(DriveWay, StopsWhereAnythingElseIsDue) {
  for (const Due due : {kSample, kPositionLoop, kVelocityLoop, kCurrentLoop, kRecord}) {
    const DriveWay way = drive_way(make_schedule({{kErrorModel, 10, 0}, {due, 5, 0}}));
    EXPECT_TRUE(way.stretches.empty());
    EXPECT_EQ(way.steps, (std::vector<Tick>{5, 5}));
  }
  // what nobody is due at may be looked at
  EXPECT_TRUE(drive_way({{kCurrentLoop, 5}, {0, 5}}).stretches.empty());
}

TEST(DriveWay, HasEightStopsOnAStretchAtMost) {
  const std::vector<plant::Stretch> one = {{9, {1, 2, 3, 4, 5, 6, 7, 8}}};
  EXPECT_EQ(drive_way(schedule_of(9, 1)).stretches, one);
  const DriveWay longer = drive_way(schedule_of(10, 1));
  EXPECT_EQ(longer.stretches, one);
  EXPECT_EQ(longer.steps, std::vector<Tick>{1});  // the tenth
}

TEST(DriveWay, EndsALegAtEachStopIfAsked) {  // as CVODE needs it
  const DriveWay way = drive_way(schedule_of(10, 6), 0);
  EXPECT_TRUE(way.stretches.empty());
  EXPECT_EQ(way.steps, (std::vector<Tick>{6, 4, 2, 6, 2, 4, 6}));
}

TEST(DriveWay, HasThirtyTwoStretchesAtMost) {
  for (const Tick current : {32, 33, 34, 37}) {
    // 1 tick later in each period of the current loop: stops at 1, 2, ... current - 1 after it
    const DriveWay way = drive_way(schedule_of(current, current + 1));
    const Tick stretches = std::min<Tick>(current - 1, 32);
    EXPECT_EQ(way.stretches.size(), static_cast<std::size_t>(stretches));
    const Tick others = current - 1 - stretches;  // in two steps each; two periods have no stop
    EXPECT_EQ(way.steps.size(), static_cast<std::size_t>(2 + 2 * others)) << current;
    Tick total = 0;
    for (const DriveWay::Leg& leg : way.legs) total += leg.step;
    EXPECT_EQ(total, current * (current + 1));
  }
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
  EXPECT_TRUE(run_case(small_scenario(program, toml), "alone").result.outcome.finished);
}

TEST(ServoAxes, RunUnderCvodeWhatTheExactStepRefuses) {
  const auto with = [](const std::string& integrator) {
    return small_scenario("G1 X0.01 F100\nM30\n",
                          "[machine_override]\nintegrator = \"" + integrator +
                              "\"\n[machine_override.axis.X.friction]\nmodel = \"lugre\"\n"
                              "bristle_stiffness = \"1e15 N/m\"\n[[case]]\nname = \"alone\"\n");
  };
  EXPECT_THROW(with("exact"), InputError);
  EXPECT_TRUE(run_case(with("cvode"), "alone").result.outcome.finished);
}

TEST(ServoAxes, TakeALinearDriveHoweverStiff) {
  EXPECT_NO_THROW(standing("X.damping = \"1e12 N s/m\"\n"));
}

}  // namespace
}  // namespace servomill::sim::servo_axes_test
