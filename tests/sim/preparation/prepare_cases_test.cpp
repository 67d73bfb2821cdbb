#include "sim/preparation/prepare_cases.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/input_error.h"
#include "sim/model/scenario.h"
#include "sim/preparation/estimate.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::preparation::prepare_cases_test {
namespace {

const std::string kProgram = "G17 G21 G90 G94\nG1 X10 F3000\nM30\n";
const std::string kPlain = "[[case]]\nname = \"plain\"\n";

std::string learning(const std::string& name, int updates) {
  return "[[case]]\nname = \"" + name +
         "\"\n[[case.strategy]]\ntype = \"learning\"\nupdates = " + std::to_string(updates) + "\n";
}

TEST(UntaughtCases, HaveTheirTrialRunsBeforeThem) {
  const model::Scenario scenario =
      small_scenario(kProgram, kPlain + learning("two", 2) + learning("three", 3));
  const std::vector<PreparedCase> cases = prepare_untaught(scenario);
  ASSERT_EQ(cases.size(), 3u);
  EXPECT_EQ(cases[0].trial_runs().number, 0);
  EXPECT_EQ(cases[1].trial_runs().number, 2);
  EXPECT_EQ(cases[2].trial_runs().number, 3);
  EXPECT_DOUBLE_EQ(cases[2].trial_runs().motion, 3.0 * cases[2].duration());
  EXPECT_TRUE(cases[1].parts().lessons.empty());
}

TEST(TaughtCases, HaveMadeTheirTrialRuns) {
  const model::Scenario scenario = small_scenario(kProgram, kPlain + learning("two", 2));
  std::vector<PreparedCase> cases = prepare_untaught(scenario);
  teach(scenario, cases);
  EXPECT_EQ(cases[1].trial_runs().number, 0);
  ASSERT_EQ(cases[1].parts().lessons.size(), 1u);
  EXPECT_FALSE(cases[1].parts().lessons[0].trials.empty());
}

// The estimate before them is longer by as many runs as there are.
TEST(Estimate, ContainsTheTrialRunsToCome) {
  const model::Scenario scenario = small_scenario(kProgram, kPlain + learning("two", 2));
  std::vector<PreparedCase> cases = prepare_untaught(scenario);
  const RunEstimate before = estimate(scenario, cases, 1);
  teach(scenario, cases);
  const RunEstimate after = estimate(scenario, cases, 1);
  EXPECT_EQ(before.trial_runs, 2);
  EXPECT_EQ(after.trial_runs, 0);
  EXPECT_GT(before.computing, 1.5 * after.computing);
  EXPECT_NE(to_string(before).find("of computing with 2 trial runs"), std::string::npos);
  EXPECT_EQ(to_string(after).find("trial"), std::string::npos);
}

TEST(UntaughtCases, AreRefusedForWhatForbidsThemToLearn) {
  const std::string both = learning("both", 1) + "[[case.strategy]]\ntype = \"learning\"\n";
  EXPECT_THROW(prepare_untaught(small_scenario(kProgram, both)), InputError);
}

}  // namespace
}  // namespace servomill::sim::preparation::prepare_cases_test
