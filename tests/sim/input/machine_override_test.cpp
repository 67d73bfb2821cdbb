/// [case.machine_override]: a machine of its own for a case.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "sim/input/read_scenario.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::input::machine_override_test {
namespace {

constexpr const char* kProgram = "G17 G21 G90 G94 F6000\nG1 X50\n(MSG, back)\nG1 X0\nM2\n";

model::Scenario scenario_with(const std::string& override_of_second, const std::string& root = "") {
  return small_scenario(kProgram, root +
                                      "[[case]]\nname = \"first\"\n[[case]]\nname = \"second\"\n" +
                                      override_of_second +
                                      "\n[[quantity]]\nname = \"following_error\"\naxis = \"X\"\n");
}

std::string message(const std::string& override_of_second) {
  try {
    run::check_scenario(scenario_with(override_of_second));
  } catch (const InputError& error) {
    std::string out;
    for (const Fault& fault : error.faults()) {
      out += fmt::format("{}: {}\n", fault.place.line, fault.message);
    }
    return out;
  }
  return "";
}

TEST(MachineOverride, IsLaidOverTheMachineOfTheScenarioForThatCaseAlone) {
  const model::Scenario scenario = scenario_with(
      "[case.machine_override]\nnc.velocity_feed_forward = 0.5\naxis.Y.moving_mass = \"700 kg\"\n",
      "machine_override.nc.Kv = 50.0\n");
  const model::MachineSettings& first = scenario.machine_of(scenario.cases[0]);
  const model::MachineSettings& second = scenario.machine_of(scenario.cases[1]);
  EXPECT_FALSE(scenario.cases[0].machine);
  EXPECT_EQ(first.nc.cascade[0].kvf, 1.0);
  EXPECT_EQ(second.nc.cascade[0].kvf, 0.5);
  EXPECT_EQ(first.drives[1].M, 600.0);
  EXPECT_EQ(second.drives[1].M, 700.0);
  EXPECT_EQ(second.drives[0].M, first.drives[0].M);
  EXPECT_EQ(first.nc.cascade[0].Kv, 50.0);
  EXPECT_EQ(second.nc.cascade[0].Kv, 50.0) << "the override of the scenario holds for all cases";
}

// The lag at constant speed is v (1 - kvf) / Kv; the case without override does not notice.
TEST(MachineOverride, IsTheMachineThatTheCaseRunsOn) {
  const model::Scenario scenario =
      scenario_with("machine_override.nc.velocity_feed_forward = 0.0\n");
  const model::Scenario alone = small_scenario(kProgram, "[[case]]\nname = \"first\"\n");
  const auto lag = [](const run::CaseOutput& output) {
    return largest_of(output.result.servo, "following_error_linear", 'X',
                      rows_within(output.result.servo, 20.0, 30.0));
  };
  EXPECT_NEAR(lag(run_named_case(scenario, "second")), 0.1 / (5.0 / 60.0 * 1e3) / um,
              0.002 * 1200.0);
  const run::CaseOutput with = run_named_case(scenario, "first"),
                        without = run_named_case(alone, "first");
  EXPECT_EQ(with.result.servo.by_rows(), without.result.servo.by_rows());
}

// Limits of the axes are those of the case, when the motion is planned and when the travel is
// checked.
TEST(MachineOverride, HoldsForThePlanOfTheMotion) {
  const model::Scenario scenario = scenario_with("machine_override.axis.X.v_max = \"3 m/min\"\n");
  const double first = run_named_case(scenario, "first").duration;
  const double second = run_named_case(scenario, "second").duration;
  EXPECT_GT(second, 2.0);
  EXPECT_LT(first, 1.5);
  EXPECT_EQ(message("machine_override.axis.X.travel_mm = [-10.0, 40.0]\n"),
            "2: case second: X moves to 50.0000 mm, outside its travel; must be <= 40.0000\n4: "
            "case second: X moves to 50.0000 mm, outside its travel; must be <= 40.0000\n");
}

TEST(MachineOverride, SurvivesWritingAndReading) {
  const model::Scenario scenario = scenario_with(
      "machine_override = { nc = { Kv = \"4 m/min/mm\" }, axis.X.moving_mass = \"800 kg\" }\n");
  const model::Scenario again = read_resolved_scenario(scenario.resolved, "again");
  EXPECT_EQ(again.resolved, scenario.resolved);
  ASSERT_TRUE(again.cases[1].machine);
  EXPECT_EQ(again.cases[1].machine->drives[0].M, 800.0);
  EXPECT_EQ(again.cases[1].machine->nc.cascade[0].Kv, scenario.cases[1].machine->nc.cascade[0].Kv);
  EXPECT_FALSE(again.cases[0].machine);
}

TEST(MachineOverride, IsReadLikeAMachine) {
  EXPECT_EQ(message("machine_override = 3\n"),
            "6: case[1].machine_override = 3; must be a table\n");
  EXPECT_EQ(message("machine_override.nc.Kv = -1.0\nmachine_override.axis.X.moving_mas = 3.0\n"),
            "6: machine.nc.Kv = -1.0; must be > 0\n7: machine.axis.X.moving_mas is not known; did "
            "you mean 'moving_mass', which is also given?\n");
  EXPECT_EQ(message("machine_override.nc.Kv = \"40 m/min/mm\"\n").substr(0, 55),
            "6: case second: axis X: the servo loop is unstable with");
}

TEST(MachineOverride, LeavesAloneWhatAllCasesShare) {
  EXPECT_EQ(message("machine_override.structure = \"[w Y b X Z t]\"\n"),
            "6: case[1].machine_override = {...}; must not change the structure, which is common "
            "to all cases\n");
  for (const char* key : {"nc.preset = \"CC422\"", "nc.scale_delay_us = 10.0"}) {
    EXPECT_EQ(message(std::string("machine_override.") + key + "\n"),
              "6: case second: machine_override changes the periods of the loops or "
              "nc.scale_delay_us, which are common to all cases\n");
  }
  EXPECT_EQ(message("machine_override.nc.preset = \"CC424\"\n"), "") << "as it is";
}

}  // namespace
}  // namespace servomill::sim::input::machine_override_test
