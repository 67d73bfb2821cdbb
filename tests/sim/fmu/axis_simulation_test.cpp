/// An exported axis next to the same axis in a run.
#include "sim/fmu/axis_simulation.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "tests/sim/fmu/exported.h"
#include "tests/sim/fmu/recorded.h"

namespace servomill::sim::fmu::axis_simulation_test {
namespace {

// Moves on to the tick `to` in steps of `step`, with the setpoints of each position period.
void follow(AxisSimulation& axis, const Recorded& recorded, int joint, Tick to, Tick step) {
  while (axis.now() < to) {
    const Tick next_setpoint = (axis.now() / kPosition + 1) * kPosition;
    ASSERT_TRUE(axis.advance(std::min({to, next_setpoint, axis.now() + step}),
                             inputs_at(recorded, axis.now(), joint)));
  }
}

// Compares each recorded row; the axis gets there in steps of `step` ticks.
void expect_same_bits(const model::Scenario& scenario, const Recorded& recorded, int joint,
                      Tick step) {
  const bool linear = joint < kLinearJoints;
  const char letter = scenario.machine.chain.layout.letter_of(joint);
  const records::Series& servo = recorded.result.servo;
  const auto column = [&](const char* name) {
    return *servo.column(name + std::string(linear ? "_linear" : "_rotary"), letter);
  };
  const std::size_t x = column("true"), meas = column("meas"), v = column("velocity"),
                    i = column("current");
  const double unit = linear ? mm : deg;
  AxisSimulation axis(exported_axis(scenario, joint, 0));
  axis.settle(at_rest(recorded, joint));
  ASSERT_GT(servo.rows(), 100U);
  for (std::size_t row = 0; row < servo.rows(); ++row) {
    follow(axis, recorded, joint, static_cast<Tick>(row) * scenario.record_period, step);
    const AxisOutputs out = axis.outputs();
    ASSERT_EQ(out.position / unit, servo.at(row, x)) << letter << row;
    ASSERT_EQ(out.position_measured / unit, servo.at(row, meas)) << letter << row;
    ASSERT_EQ(out.velocity / unit, servo.at(row, v)) << letter << row;
    ASSERT_EQ(out.current, servo.at(row, i)) << letter << row;
  }
}

TEST(AxisSimulation, GivesTheBitsOfARun) {
  const model::Scenario scenario = rich_scenario();
  const Recorded recorded = recorded_of(scenario, "plain");
  for (int joint = 0; joint < kJoints; ++joint) {
    expect_same_bits(scenario, recorded, joint, kPosition);
  }
}

TEST(AxisSimulation, GivesThemBehindATable) {
  const model::Scenario scenario = rich_scenario(
      "[errors.imposed]\nEYX = { harmonic = { amplitude_um = 150.0, period_mm = 62.0 } }\n"
      "[[case]]\nname = \"table\"\n[[case.strategy]]\ntype = \"table\"\nmodel = \"imposed\"\n"
      "action = \"impose\"\nbase_axis = \"X\"\nfrom_mm = -50.0\nto_mm = 50.0\n"
      "spacing_mm = 1.6384\n");
  const Recorded recorded = recorded_of(scenario, "table");
  EXPECT_NE(recorded.setpoints.back().Q_cmd[1], recorded.setpoints.back().Q_ref[1]);
  expect_same_bits(scenario, recorded, 1, kPosition);
}

TEST(AxisSimulation, GivesThemForAnyCommunicationStep) {
  const model::Scenario scenario = rich_scenario();
  const Recorded recorded = recorded_of(scenario, "plain");
  for (const Tick step : {1, 3, 7}) expect_same_bits(scenario, recorded, 1, step);
}

TEST(AxisSimulation, TakesUpALoadBetweenTwoInstants) {
  const AxisConstants constants = exported_axis(rich_scenario(), 1, 0);
  // position after 2 ms under a load from tick `from` on
  const auto position = [&](Tick from, Tick stop_at) {
    AxisSimulation axis(constants);
    axis.settle({});
    EXPECT_TRUE(axis.advance(stop_at, {}));
    EXPECT_TRUE(axis.advance(from, {}));
    EXPECT_TRUE(axis.advance(200, {.load = 2000.0}));
    return axis.outputs().position;
  };
  const double at_20 = position(20, 20), at_23 = position(23, 20), at_30 = position(30, 20);
  EXPECT_GT(at_20, at_23);
  EXPECT_GT(at_23, at_30);
  EXPECT_GT(at_30, 0.0);
  EXPECT_EQ(position(23, 21), at_23);
}

TEST(AxisSimulation, GoesOnFromAMemoryWithTheSameBits) {
  const model::Scenario scenario = rich_scenario();
  const Recorded recorded = recorded_of(scenario, "plain");
  const AxisConstants constants = exported_axis(scenario, 2, 0);
  AxisSimulation axis(constants), other(constants);
  axis.settle(at_rest(recorded, 2));
  follow(axis, recorded, 2, 5003, 7);  // on the way between two instants
  const AxisSimulation::Memory memory = axis.memory();
  follow(axis, recorded, 2, 9000, 7);
  const double end = axis.outputs().position;
  other.restore(memory);
  follow(other, recorded, 2, 9000, 7);
  EXPECT_EQ(other.outputs().position, end);
  axis.restore(memory);
  follow(axis, recorded, 2, 9000, 7);
  EXPECT_EQ(axis.outputs().position, end);
}

TEST(AxisSimulation, SettlesAgainAsAtFirst) {
  const model::Scenario scenario = rich_scenario();
  const Recorded recorded = recorded_of(scenario, "plain");
  AxisSimulation axis(exported_axis(scenario, 1, 0));  // its scale is noisy
  std::vector<double> ends;
  for (int time = 0; time < 2; ++time) {
    axis.settle(at_rest(recorded, 1));
    follow(axis, recorded, 1, 5003, 100);
    ends.push_back(axis.outputs().position);
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(AxisSimulation, StopsWhereTheNcStopsTheMachine) {
  AxisSimulation axis(exported_axis(rich_scenario(), 0, 0));
  axis.settle({});
  EXPECT_TRUE(axis.advance(40, {}));
  EXPECT_FALSE(axis.advance(1000, {.setpoint = 20 * mm}));
  EXPECT_EQ(axis.now(), 40);
  EXPECT_EQ(axis.fault(), "following error beyond 10 mm");
}

TEST(AxisSimulation, AddsAVirtualDisplacementToTheReading) {
  AxisSimulation axis(exported_axis(rich_scenario(), 0, 0));
  axis.settle({.setpoint = 1 * mm, .feedback_displacement = 0.1 * mm});
  EXPECT_NEAR(axis.outputs().position, 0.9 * mm, 20e-9);  // a step of the scale
}

}  // namespace
}  // namespace servomill::sim::fmu::axis_simulation_test
