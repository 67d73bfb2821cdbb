/// Quantities that have a budget, asked for or not.
#include "sim/run/budget_quantities.h"

#include "sim/model/scenario.h"
#include "tests/sim/run/small_budget.h"

namespace servomill::sim::run::budget_quantities_test {
namespace {

using small_budget::kProgram;

// Deviation of the tool and following error belong to every case, asked for or not.
TEST(BudgetQuantities, IsThereForCasesThatNobodyAsksAbout) {
  const model::Scenario scenario =
      small_scenario(kProgram,
                     "[[case]]\nname = \"one\"\n[[case]]\nname = \"two\"\n"
                     "[[quantity]]\nname = \"contour_error\"\n"
                     "[[quantity]]\nname = \"following_error\"\naxis = \"X\"\n"
                     "cases = [\"two\"]\n");
  EXPECT_EQ(budget_quantities(scenario).size(), 1U);
  const std::vector<std::string> both = {"tool_deviation", "following_error"};
  const auto quantities = budget_quantities(scenario, both, {"flank"});
  ASSERT_EQ(quantities.size(), 1U + 2U * 3U);  // as it is; two cases of X, Y, Z
  for (const model::QuantitySpec& one : quantities) {
    EXPECT_EQ(one.sections, std::vector<std::string>{"flank"});
  }
}

}  // namespace
}  // namespace servomill::sim::run::budget_quantities_test
