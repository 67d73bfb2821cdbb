/// Strategies that act together: none corrects again what another one does.
#include <gtest/gtest.h>

#include <string>

#include "plant/vocabulary/input_error.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::combinations_test {
namespace {

std::string refusal(const std::string& strategies) {
  return refusal_of(
      "[errors.machine]\nEYX = { um_per_m = 50.0 }\n[errors.rest]\n"
      "relative_to = \"machine\"\nEYX = { um_per_m = -30.0 }\n[[case]]\nname = \"one\"\n" +
      strategies);
}

std::string strategy(const std::string& type, const std::string& model = "machine") {
  return "[[case.strategy]]\ntype = \"" + type + "\"\nmodel = \"" + model + "\"\n" +
         (type == "table" ? "spacing_mm = 6.5536\n" : "");
}

// A table and a rewritten program for the same errors would correct them twice.
TEST(Combinations, ThatCorrectAModelTwiceAreRefused) {
  EXPECT_EQ(refusal(strategy("table") + strategy("gcode")),
            "small.toml:14:8: error: case one: strategy gcode would correct the errors of model "
            "'machine' a second time, after table; use a model of the residual (relative_to)");
  EXPECT_EQ(refusal(strategy("gcode")), "accepted");
}

TEST(Combinations, ThatShareErrorsAreAccepted) {
  EXPECT_EQ(refusal(strategy("table", "rest") + strategy("gcode")), "accepted");
  EXPECT_EQ(refusal(strategy("table") + strategy("gcode") + "action = \"impose\"\n"), "accepted");
  EXPECT_EQ(refusal(strategy("table") + "base_axis = \"X\"\n" + strategy("table") +
                    "base_axis = \"Y\"\nzero_at_reference = true\n"),
            "accepted");
}

// It runs the program with the table in action, and sees what that leaves.
TEST(Combinations, OfAStrategyThatLearnsCorrectTheRest) {
  EXPECT_EQ(refusal(strategy("table") + strategy("precompensation")), "accepted");
  EXPECT_EQ(refusal(strategy("table") + "[[case.strategy]]\ntype = \"learning\"\nupdates = 1\n"),
            "accepted");
}

// A rewritten program is no path to be learnt to: errors that it corrects must stay corrected.
TEST(Combinations, OfARewrittenProgramAndAStrategyThatLearnsKeepTheProgrammedPath) {
  const std::string errors = "[errors.machine]\nEYX = { um_per_m = 500.0 }\n";
  const auto one_case = [](const std::string& name, const std::string& strategies) {
    return "[[case]]\nname = \"" + name + "\"\nmachine_errors = \"machine\"\n" + strategies;
  };
  const std::string learning = "[[case.strategy]]\ntype = \"learning\"\nupdates = 2\n";
  const model::Scenario scenario =
      small_scenario("G21 G90 G94 G61\nG4 P0.2\nG1 X60 F3000\nG4 P0.2\nM30\n",
                     errors + one_case("plain", "") + one_case("gcode", strategy("gcode")) +
                         one_case("both", strategy("gcode") + learning) +
                         one_case("program", strategy("gcode") + strategy("precompensation") +
                                                 "as = \"program\"\nmax_runs = 3\n"));
  const auto deviation = [&](const std::string& name) {
    const CaseOutput one = run_named_case(scenario, name);
    return largest_of(one.result.servo, "tool_deviation", 'Y',
                      rows_within(one.result.servo, 20.0, 50.0));
  };
  EXPECT_NEAR(deviation("plain"), 25.0, 0.5);
  EXPECT_LT(deviation("gcode"), 0.2);
  EXPECT_LT(deviation("both"), 0.2);
  EXPECT_LT(deviation("program"), 0.2);
}

TEST(Combinations, ThatALearningStrategyWouldTakeBackAreRefused) {
  const std::string scales =
      "[[case.strategy]]\ntype = \"learning\"\nsees = \"scales\"\nupdates = 1\n";
  EXPECT_EQ(refusal(strategy("table") + scales),
            "small.toml:15:8: error: case one: strategy learning: sees = \"scales\" would cancel "
            "the displacement of table; use \"tip\", or only one of the two strategies");
  EXPECT_EQ(refusal("[[case.strategy]]\ntype = \"contour\"\n" + scales), "accepted");
  EXPECT_EQ(refusal(strategy("gcode") + "action = \"impose\"\n[[case.strategy]]\n"
                                        "type = \"learning\"\nupdates = 1\n"),
            "small.toml:14:8: error: case one: strategy learning: would correct the errors that "
            "gcode imposes");
}

}  // namespace
}  // namespace servomill::sim::run::combinations_test
