/// Estimates of budgets before they are found.
#include "sim/run/budget_estimate.h"

#include "sim/model/scenario.h"
#include "tests/sim/run/small_budget.h"

namespace servomill::sim::run::budget_estimate_test {
namespace {

using namespace small_budget;

constexpr preparation::RunEstimate kHour{
    .motion = 3600.0, .rows = 1e6, .size = 8e7, .file = 1e7, .memory = 1e8, .computing = 36.0};

// All causes, without measurement, three that add, all of these together, and two of the chain.
TEST(BudgetEstimate, CountsRunsAndPairsOfTheCausesOfAllCases) {
  const std::map<std::string, Causes> present = {
      {"a", {Cause::lag, Cause::measurement, Cause::friction, Cause::cutting}},
      {"b", {Cause::lag, Cause::interpolation, Cause::friction, Cause::heat}}};
  const BudgetEstimate found = budget_estimate(kHour, present, 2);
  EXPECT_EQ(found.runs, 1 + 1 + 3 + 1 + 2);
  EXPECT_EQ(found.pairs, 3);
  EXPECT_EQ(found.computing(), 8 * 36.0);
  EXPECT_EQ(found.computing_pairs(), 3 * 36.0);
  EXPECT_TRUE(is_worth_telling(found));
}

// Rows of 10 numbers: four recordings of 10 columns in two cases, and a budget of one of them with
// 5 + 2 (2 + 1) + 1 columns.
TEST(BudgetEstimate, HasTheDiskSpaceOfRecordingsAndSignals) {
  const std::map<std::string, Causes> present = {{"a", {Cause::friction, Cause::cutting}},
                                                 {"b", {Cause::friction}}};
  const BudgetEstimate found = budget_estimate(kHour, present, 1);
  EXPECT_NEAR(found.disk, 4.0 * 1e7 + 0.5e7 * 12.0 / 10.0, 1.0);
  EXPECT_EQ(to_string(found),
            "4 runs, each 60 min of motion, 1e+06 rows, 0.08 GB of signals in a file of 0.01 GB, "
            "0.1 GB of memory, about 36 s of computing; up to 1 runs more, of pairs of causes, "
            "where remainders are large; 0.046 GB of disk space while running");
}

// Once, and with what the first run takes.
TEST(BudgetEstimate, IsToldBeforeTheFirstRun) {
  const model::Scenario scenario =
      small_scenario(kProgram, root("polynomial_um = [0.0, 0.0, 0.05]") + one_case(kTableOverX));
  BudgetControl control;
  int reports = 0;
  control.prepared = [&](const BudgetEstimate& takes) {
    ++reports;
    EXPECT_GT(takes.runs, 3);
    EXPECT_GT(takes.run.rows, 1e3);
  };
  find_budgets(scenario, budget_quantities(scenario), control);
  EXPECT_EQ(reports, 1);
}

}  // namespace
}  // namespace servomill::sim::run::budget_estimate_test
