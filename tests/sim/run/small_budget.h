/// Budgets of small scenarios: one axis, one section, one strategy.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "sim/run/budget.h"
#include "sim/run/budget_quantities.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::small_budget {

inline constexpr double kFeed = 1394.0 / 60.0;  // mm/s
inline constexpr double kKv = 60.0;             // 1/s
inline constexpr const char* kProgram =
    "G17 G21 G40 G90 G94 G64 P0.0002\nG1 X20 F1394\n(MSG, flank)\nG1 X80\n(MSG, leave)\nG1 "
    "X90\nM30\n";

// @param eyx  of the imposed model, um over mm
inline std::string root(const std::string& eyx, const std::string& more = "") {
  return "imposed = \"imposed\"\n[machine_override.nc]\nKv = \"60 1/s\"\n[errors.imposed]\nEYX = "
         "{ " +
         eyx + " }\n" + more + "[[case]]\nname = \"nominal\"\n";
}

inline std::string quantity(const std::string& name, char axis,
                            const std::string& section = "flank") {
  return fmt::format(
      "[[quantity]]\nname = \"{}\"\naxis = \"{}\"\nsections = [\"{}\"]\ncases = [\"one\"]\n", name,
      axis, section);
}

inline const std::string kTableOverX =
    "type = \"table\"\nbase_axis = \"X\"\nfrom_mm = -20.0\nto_mm = 100.0\nmodel = \"imposed\"\n";

inline std::string one_case(const std::string& strategy, const std::string& more = "") {
  return "[[case]]\nname = \"one\"\n" + more + "[[case.strategy]]\naction = \"impose\"\n" +
         strategy + quantity("imposed_error_residual", 'Y') + "baseline = \"nominal\"\n";
}

// Parts and remainder make the residual, at each place.
inline void expect_sum(const Budget& budget) {
  constexpr double kRounding = 1e-9;  // um, of sums of some hundred um
  const std::vector<double> residual = budget.residual.signal.all(), s = budget.s.all();
  std::vector<double> sum = budget.remainder.signal.all();
  for (const BudgetPart& one : budget.parts) {
    const std::vector<double> part = one.signal.all();
    for (std::size_t n = 0; n < part.size(); ++n) sum[n] += part[n];
  }
  for (std::size_t n = 0; n < s.size(); ++n) {
    ASSERT_NEAR(sum[n], residual[n], kRounding) << "at s = " << s[n];
  }
}

// Shares and what pairs leave make the residual, at each place.
inline void expect_sum_of_shares(const Budget& budget) {
  constexpr double kRounding = 1e-9;  // um, of sums of some hundred um
  const std::vector<double> residual = budget.residual.signal.all();
  std::vector<double> sum = budget.unexplained.signal.all();
  for (const BudgetPart& one : budget.parts) {
    const std::vector<double> share = one.share.signal.all();
    ASSERT_EQ(share.size(), one.present ? sum.size() : 0U);
    for (std::size_t n = 0; n < share.size(); ++n) sum[n] += share[n];
  }
  for (std::size_t n = 0; n < sum.size(); ++n) ASSERT_NEAR(sum[n], residual[n], kRounding);
}

inline Budget budget_of(const std::string& toml, const char* program = kProgram) {
  const model::Scenario scenario = small_scenario(program, toml);
  const auto budgets = find_budgets(scenario, budget_quantities(scenario));
  EXPECT_EQ(budgets.size(), 1U);
  EXPECT_EQ(budgets.front().note, "");
  expect_sum(budgets.front());
  return budgets.front();
}

inline const BudgetPart& part(const Budget& budget, Cause cause) {
  return budget.parts[static_cast<std::size_t>(cause)];
}

inline double largest(const BudgetSignal& signal) {
  double out = 0.0;
  for (const double v : signal.signal.all()) out = std::max(out, std::abs(v));
  return out;
}

// All but some.
inline void expect_nothing_else(const Budget& budget, const std::vector<Cause>& but, double least) {
  for (const BudgetPart& one : budget.parts) {
    if (std::find(but.begin(), but.end(), one.cause) != but.end()) continue;
    EXPECT_LT(largest(one), least) << info_of(one.cause).name;
  }
  EXPECT_LT(largest(budget.remainder), least);
}

}  // namespace servomill::sim::run::small_budget
