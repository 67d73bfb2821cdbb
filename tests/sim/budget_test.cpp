/// Error budgets: causes with a known answer each get theirs, and no more.
#include "sim/budget.h"

#include <gtest/gtest.h>

#include <numbers>

#include "plant/vocabulary/units.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim {
namespace {

constexpr double kFeed = 1394.0 / 60.0;  // mm/s
constexpr double kKv = 60.0;             // 1/s
constexpr const char* kProgram =
    "G17 G21 G40 G90 G94 G64 P0.0002\nG1 X20 F1394\n(MSG, flank)\nG1 X80\n(MSG, leave)\nG1 "
    "X90\nM30\n";

// @param eyx  of the imposed model, um over mm
std::string root(const std::string& eyx, const std::string& more = "") {
  return "imposed = \"imposed\"\n[machine_override.nc]\nKv = \"60 1/s\"\n[errors.imposed]\nEYX = "
         "{ " +
         eyx + " }\n" + more + "[[case]]\nname = \"nominal\"\n";
}

std::string one_case(const std::string& strategy, const std::string& more = "") {
  return "[[case]]\nname = \"one\"\n" + more + "[[case.strategy]]\nsign = \"generate\"\n" +
         strategy +
         "[[quantity]]\nname = \"imposed_curve_residual\"\naxis = \"Y\"\nbase = \"nominal\"\n"
         "sections = [\"flank\"]\ncases = [\"one\"]\n";
}

Budget budget_of(const std::string& toml, const char* program = kProgram) {
  const Scenario scenario = small_scenario(program, toml);
  const auto budgets = find_budgets(scenario, budget_quantities(scenario));
  EXPECT_EQ(budgets.size(), 1U);
  EXPECT_EQ(budgets.front().note, "");
  return budgets.front();
}

const BudgetPart& part(const Budget& budget, Cause cause) {
  return budget.parts[static_cast<std::size_t>(cause)];
}

double largest(const std::vector<double>& values) {
  double out = 0.0;
  for (const double v : values) out = std::max(out, std::abs(v));
  return out;
}

// All but some.
void expect_nothing_else(const Budget& budget, const std::vector<Cause>& but, double least) {
  for (const BudgetPart& one : budget.parts) {
    if (std::find(but.begin(), but.end(), one.cause) != but.end()) continue;
    EXPECT_LT(largest(one.signal), least) << info_of(one.cause).name;
  }
  EXPECT_LT(largest(budget.remainder), least);
}

// A table behind the feed-forward tap, of a straight error curve: behind by slope v / Kv.
TEST(Budget, OfLagAlone) {
  constexpr double kSlope = 10.0;  // um/mm
  const Budget budget = budget_of(
      root("polynomial_um = [0.0, 10.0]") +
      one_case(
          "type = \"table\"\naxis = \"X\"\nfrom_mm = -20.0\nto_mm = 100.0\nmodel = \"imposed\"\n"));
  const double lag = kSlope * kFeed / kKv;  // 3.87 um
  constexpr double kSome = 0.01;            // share; the path is a little slower at the ends
  EXPECT_NEAR(part(budget, Cause::lag).at_place, -lag, kSome * lag);
  EXPECT_NEAR(part(budget, Cause::lag).rms, lag, 2.0 * kSome * lag);
  EXPECT_NEAR(budget.residual_at_place(), -lag, kSome * lag);
  expect_nothing_else(budget, {Cause::lag}, 0.03 * lag);  // encoder steps and path tolerance
}

TEST(Budget, OfADelayAlone) {
  constexpr double kSlope = 10.0;  // um/mm
  const Budget budget = budget_of(
      root("polynomial_um = [0.0, 10.0]") +
      one_case(
          "type = \"table\"\naxis = \"X\"\nfrom_mm = -20.0\nto_mm = 100.0\nmodel = \"imposed\"\n"
          "dead_time_ms = 20.0\nresponse_time_ms = 30.0\n",
          "servo = \"ideal\"\n"));
  const double behind = kSlope * kFeed * 50e-3;  // 11.6 um
  EXPECT_NEAR(part(budget, Cause::delay).at_place, -behind, 0.01 * behind);
  expect_nothing_else(budget, {Cause::delay}, 0.01 * behind);
}

// EYX = 0.1 um/mm^2 x^2 / 2: the chord of an interval is off by spacing^2 / 8 times the curvature.
TEST(Budget, OfTheSpacingOfATableAlone) {
  const Budget budget = budget_of(root("polynomial_um = [0.0, 0.0, 0.05]") +
                                  one_case("type = \"table\"\naxis = \"X\"\nfrom_mm = -20.0\nto_mm "
                                           "= 100.0\nmodel = \"imposed\"\nspacing_mm = 6.5536\n",
                                           "servo = \"ideal\"\n"));
  const double chord = 6.5536 * 6.5536 / 8.0 * 0.1;  // 0.537 um
  EXPECT_NEAR(part(budget, Cause::table).at_place, chord, 0.01 * chord);
  EXPECT_NEAR(part(budget, Cause::table).at_place, budget.residual_at_place(), 1e-3 * chord);
  EXPECT_NEAR(part(budget, Cause::table).rms, std::sqrt(8.0 / 15.0) * chord, 0.02 * chord);
  expect_nothing_else(budget, {Cause::table}, 0.01 * chord);
}

// Believed 10.5 um/mm in place of 10, once by each way of correcting.
TEST(Budget, OfAnIdentificationErrorAlone) {
  const std::string errors = root("polynomial_um = [0.0, 10.0]",
                                  "[errors.belief]\nEYX = { polynomial_um = [0.0, 10.5] }\n");
  const std::string table = "type = \"table\"\naxis = \"X\"\nfrom_mm = -20.0\nto_mm = 100.0\n";
  for (const std::string& type : {table, std::string("type = \"feedback\"\nmax_um = 2000.0\n"),
                                  std::string("type = \"gcode\"\n")}) {
    const Budget budget =
        budget_of(errors + one_case(type + "model = \"belief\"\n", "servo = \"ideal\"\n"));
    const double wrong = 0.5 * 80.0;  // um, where the section ends
    EXPECT_NEAR(part(budget, Cause::identification).at_place, wrong, 0.01 * wrong) << type;
    expect_nothing_else(budget, {Cause::identification}, 0.01 * wrong);
  }
}

// The origin of a rewritten program counts as identification: 10 um/mm, 7 mm away.
TEST(Budget, OfAnotherOriginAlone) {
  const Budget budget =
      budget_of(root("polynomial_um = [0.0, 10.0]") +
                one_case("type = \"gcode\"\nmodel = \"imposed\"\nrewritten_for = \"program\"\n",
                         "servo = \"ideal\"\nwork_offset = { X_mm = 7.0 }\n"));
  EXPECT_NEAR(part(budget, Cause::identification).at_place, -70.0, 0.1);
  expect_nothing_else(budget, {Cause::identification}, 0.1);
}

// 150 um wanted, 100 allowed.
TEST(Budget, OfSaturationAlone) {
  const Budget budget =
      budget_of(root("constant_um = 150.0") +
                one_case("type = \"feedback\"\nmodel = \"imposed\"\nmax_um = 100.0\n"));
  EXPECT_NEAR(part(budget, Cause::saturation).at_place, -50.0, 0.1);
  expect_nothing_else(budget, {Cause::saturation}, 0.1);
}

// Chords of 4 mm at a curvature of 0.1 um/mm^2, which the tolerance allows.
TEST(Budget, OfChordsAlone) {
  const Budget budget =
      budget_of(root("polynomial_um = [0.0, 0.0, 0.05]") +
                one_case("type = \"gcode\"\nmodel = \"imposed\"\nmax_block_mm = 4.0\n"
                         "tolerance_um = 1.0\n",
                         "servo = \"ideal\"\n"));
  const double chord = 4.0 * 4.0 / 8.0 * 0.1;  // 0.2 um, less what rounding its corners takes
  EXPECT_NEAR(part(budget, Cause::interpolation).at_place, chord, 0.1 * chord);
  expect_nothing_else(budget, {Cause::interpolation}, 0.05 * chord);
}

// Without a strategy all of it stays.
TEST(Budget, OfWhatNobodyCorrects) {
  const Scenario scenario = small_scenario(
      kProgram,
      "truth = \"machine\"\n[errors.machine]\nEYX = { polynomial_um = [0.0, 1.0] }\n"
      "[[case]]\nname = \"one\"\nservo = \"ideal\"\n"
      "[[quantity]]\nname = \"tool_deviation\"\naxis = \"Y\"\nsections = [\"flank\"]\n");
  const auto budgets = find_budgets(scenario, budget_quantities(scenario));
  ASSERT_EQ(budgets.size(), 1U);
  EXPECT_NEAR(part(budgets[0], Cause::kinematics).at_place, 80.0, 0.1);
  expect_nothing_else(budgets[0], {Cause::kinematics}, 0.1);
}

// An ideal servo stands where the NC wants it, but the structure gives way to the cut.
TEST(Budget, OfTheCutAlone) {
  const Scenario scenario = small_scenario(
      "G17 G90 T1 M6\nG43 H1\nS4775 M3\nG0 X-30 Y0\nZ-2\n(MSG, slot)\nG1 X30 F1394\nM30\n",
      "[machine_override.axis.Y]\nstructural_stiffness = \"40 N/um\"\n[[program.tool]]\nnumber = "
      "1\nlength_mm = 110.0\ndiameter_mm = 8.0\nteeth = 4\n[[part.stock]]\nbox = { from_mm = "
      "[-20.0, -20.0, -20.0], to_mm = [20.0, 20.0, 0.0] }\n[cutting]\nmaterial = \"42CrMo4\"\n"
      "[[case]]\nname = \"one\"\nservo = \"ideal\"\n"
      "[[quantity]]\nname = \"tool_deviation\"\naxis = \"Y\"\nsections = [\"slot\"]\n");
  const auto budgets = find_budgets(scenario, budget_quantities(scenario));
  ASSERT_EQ(budgets.size(), 1U);
  const double residual = budgets[0].residual_at_place();
  EXPECT_GT(std::abs(residual), 1.0);
  EXPECT_NEAR(part(budgets[0], Cause::cutting).at_place, residual, 1e-6);
  expect_nothing_else(budgets[0], {Cause::cutting}, 1e-6);
}

// Experiment 1 of [G], its flank: what strategies leave is accounted for within 10 %.
TEST(Budget, AddsUpForExperiment1) {
  constexpr const char* kFlank =
      "G17 G21 G40 G90 G94 G64 P0.0002\nG1 X-20 F1394\nG1 X-15\n(MSG, flank)\nG1 X70\n"
      "(MSG, leave)\nG1 X75\nM30\n";
  const auto strategy = [](const char* name, const std::string& keys) {
    return std::string("[[case]]\nname = \"") + name +
           "\"\n[[case.strategy]]\nmodel = \"imposed\"\nsign = \"generate\"\n" + keys;
  };
  const std::string toml =
      root("harmonic = { amplitude_um = 150.0, period_mm = 62.0 }",
           "[feedback_hardware]\nconnected = true\n") +
      strategy("table",
               "type = \"table\"\naxis = \"X\"\nfrom_mm = -200.0\nto_mm = 200.0\n"
               "response_time_ms = 40.0\n") +
      strategy("feedback", "type = \"feedback\"\n") + strategy("gcode", "type = \"gcode\"\n") +
      strategy("lead", "type = \"feedback\"\nlead_ms = \"auto\"\niterations = \"converged\"\n") +
      "[[quantity]]\nname = \"imposed_curve_residual\"\naxis = \"Y\"\nbase = \"nominal\"\n"
      "sections = [\"flank\"]\ncases = [\"table\", \"feedback\", \"gcode\", \"lead\"]\n"
      "[[quantity]]\nname = \"brought_out\"\naxis = \"Y\"\nbase = \"nominal\"\n"
      "sections = [\"flank\"]\ncases = [\"table\"]\n";  // the same once more
  const Scenario scenario = small_scenario(kFlank, toml);
  const auto budgets = find_budgets(scenario, budget_quantities(scenario));
  ASSERT_EQ(budgets.size(), 4U);
  constexpr double kShare = 0.1;  // of the residual, as wanted
  for (const Budget& budget : budgets) {
    const std::string& name = budget.quantity.cases.front();
    RecordProperty(name + "_residual_um", std::to_string(budget.residual_at_place()));
    RecordProperty(name + "_remainder_um", std::to_string(budget.remainder_at_place()));
    EXPECT_LT(std::abs(budget.remainder_at_place()), kShare * std::abs(budget.residual_at_place()))
        << name;
    EXPECT_LT(budget.remainder_rms, kShare * budget.residual_rms()) << name;
  }
  // the table's own response is most of what it leaves, lag most of what feedback does
  EXPECT_GT(part(budgets[0], Cause::delay).rms, 2.0 * part(budgets[0], Cause::lag).rms);
  EXPECT_GT(part(budgets[1], Cause::lag).rms, 0.9 * budgets[1].residual_rms());
  EXPECT_GT(part(budgets[2], Cause::interpolation).rms, part(budgets[2], Cause::lag).rms);
}

TEST(Budget, SaysWhyThereIsNone) {
  const Scenario scenario = small_scenario(
      kProgram, root("polynomial_um = [0.0, 10.0]") +
                    one_case("type = \"table\"\naxis = \"X\"\nfrom_mm = -20.0\nto_mm = "
                             "100.0\nmodel = \"imposed\"\n",
                             "[case.machine_override.nc]\nfollowing_error_limit_mm = 1e-6\n"));
  const auto budgets = find_budgets(scenario, budget_quantities(scenario));
  ASSERT_EQ(budgets.size(), 1U);
  EXPECT_TRUE(budgets[0].note.starts_with("case one stopped: axis ")) << budgets[0].note;
}

}  // namespace
}  // namespace servomill::sim
