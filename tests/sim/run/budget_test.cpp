/// Error budgets: causes add up with a remainder, and what there is none of is said.
#include "sim/run/budget.h"

#include "sim/model/scenario.h"
#include "tests/sim/run/small_budget.h"

namespace servomill::sim::run::budget_test {
namespace {

using namespace small_budget;

// Loops and a table's response are behind by v / Kv and v tau along a parabola's slope, and the
// table's points off by its chords, whichever else there is.
TEST(Budget, OfATableWithAllOfItsCausesAddsUp) {
  const Budget budget =
      budget_of(root("polynomial_um = [0.0, 0.0, 0.05]") +
                one_case(kTableOverX + "spacing_mm = 6.5536\ndead_time_ms = 50.0\n"));
  const double slope = 0.1 * 80.0;  // um/mm, where the section ends
  const double lag = slope * kFeed / kKv, delay = slope * kFeed * 50e-3;  // 3.1, 9.3 um
  const double chord = 6.5536 * 6.5536 / 8.0 * 0.1;                       // 0.537 um
  EXPECT_NEAR(part(budget, Cause::lag).signal.all().back(), -lag, 0.02 * lag);
  EXPECT_NEAR(part(budget, Cause::delay).signal.all().back(), -delay, 0.02 * delay);
  EXPECT_NEAR(largest(part(budget, Cause::table)), chord, 0.05 * chord);
  EXPECT_LT(largest(budget.remainder), 1e-3 * std::abs(budget.residual.at_place));
}

// The rest without all other causes has a name that says whose it is.
TEST(Budget, NamesWhatStays) {
  const std::string errors =
      "machine_errors = \"machine\"\nimposed = \"wanted\"\n[errors.machine]\n"
      "EYX = { polynomial_um = [0.0, 1.0] }\n[errors.wanted]\nEYX = { polynomial_um = [0.0, 3.0] "
      "}\n[[case]]\nname = \"nominal\"\nservo = \"ideal\"\n"
      "[[case]]\nname = \"one\"\nservo = \"ideal\"\n";
  const std::string generate =
      "[[case.strategy]]\ntype = \"feedback\"\nmodel = \"wanted\"\naction = \"impose\"\n";
  const std::string correct = "[[case.strategy]]\ntype = \"feedback\"\nmodel = \"machine\"\n";
  const std::string of_tool = quantity("tool_deviation", 'Y');
  const std::string of_curve = quantity("imposed_error_residual", 'Y') + "baseline = \"nominal\"\n";

  const Budget nobody = budget_of(errors + of_tool);
  EXPECT_NEAR(part(nobody, Cause::uncorrected).at_place, 80.0, 0.1);
  expect_nothing_else(nobody, {Cause::uncorrected}, 0.1);

  const Budget corrected = budget_of(errors + correct + of_tool);
  EXPECT_FALSE(part(corrected, Cause::uncorrected).present);
  EXPECT_TRUE(part(corrected, Cause::uncorrectable).present);
  expect_nothing_else(corrected, {}, 0.1);

  const Budget both = budget_of(errors + generate + of_tool);
  EXPECT_NEAR(part(both, Cause::uncorrected).at_place, 80.0, 0.1);
  EXPECT_NEAR(part(both, Cause::imposed).at_place, 240.0, 0.5);
  expect_nothing_else(both, {Cause::uncorrected, Cause::imposed}, 0.1);

  const Budget not_realised = budget_of(errors + of_curve);
  EXPECT_NEAR(part(not_realised, Cause::uncorrected).at_place, -240.0, 0.1);
  expect_nothing_else(not_realised, {Cause::uncorrected}, 0.1);
}

// Experiment 1 of [G], its flank: what strategies leave is accounted for within 1 %.
TEST(Budget, AddsUpForExperiment1) {
  constexpr const char* kFlank =
      "G17 G21 G40 G90 G94 G64 P0.0002\nG1 X-20 F1394\nG1 X-15\n(MSG, flank)\nG1 X70\n"
      "(MSG, leave)\nG1 X75\nM30\n";
  const auto strategy = [](const char* name, const std::string& keys) {
    return std::string("[[case]]\nname = \"") + name +
           "\"\n[[case.strategy]]\nmodel = \"imposed\"\naction = \"impose\"\n" + keys;
  };
  const std::string toml =
      root("harmonic = { amplitude_um = 150.0, period_mm = 62.0 }",
           "[feedback_hardware]\nconnected = true\n") +
      strategy("table",
               "type = \"table\"\nbase_axis = \"X\"\nfrom_mm = -200.0\nto_mm = 200.0\n"
               "time_constant_ms = 40.0\n") +
      strategy("feedback", "type = \"feedback\"\n") + strategy("gcode", "type = \"gcode\"\n") +
      strategy(
          "lead",
          "type = \"feedback\"\nextrapolation_time_ms = \"auto\"\niterations = \"converged\"\n") +
      "[[quantity]]\nname = \"imposed_error_residual\"\naxis = \"Y\"\nbaseline = \"nominal\"\n"
      "sections = [\"flank\"]\ncases = [\"table\", \"feedback\", \"gcode\", \"lead\"]\n"
      "[[quantity]]\nname = \"realised_ratio\"\naxis = \"Y\"\nbaseline = \"nominal\"\n"
      "sections = [\"flank\"]\ncases = [\"table\"]\n";  // the same once more
  const model::Scenario scenario = small_scenario(kFlank, toml);
  const auto budgets = find_budgets(scenario, budget_quantities(scenario));
  ASSERT_EQ(budgets.size(), 4U);
  constexpr double kShare = 0.01;  // of the residual
  for (const Budget& budget : budgets) {
    expect_sum(budget);
    const std::string& name = budget.quantity.cases.front();
    RecordProperty(name + "_residual_um", std::to_string(budget.residual.at_place));
    RecordProperty(name + "_remainder_um", std::to_string(budget.remainder.at_place));
    EXPECT_LT(std::abs(budget.remainder.at_place), kShare * std::abs(budget.residual.at_place))
        << name;
    EXPECT_LT(budget.remainder.rms, kShare * budget.residual.rms) << name;
  }
  // the table's own response is most of what it leaves, lag most of what feedback does
  EXPECT_GT(part(budgets[0], Cause::delay).rms, 2.0 * part(budgets[0], Cause::lag).rms);
  EXPECT_GT(part(budgets[1], Cause::lag).rms, 0.9 * budgets[1].residual.rms);
  EXPECT_GT(part(budgets[2], Cause::interpolation).rms, part(budgets[2], Cause::lag).rms);
}

// Errors over two axes that are known in part, friction, modes, a bed, heat and single teeth: what
// no cause alone explains, and where that is much no pair of them, is within a tenth of what stays,
// or 0.05 um.
TEST(Budget, AddsUpOnAMachineWithEveryCause) {
  const std::string toml =
      "machine_errors = \"measured\"\n"
      "[machine_override]\nfriction_model = \"lugre\"\nstructural_mode = [{ direction = [1.0, 0.3, "
      "0.0], stiffness = \"40 N/um\", frequency_Hz = 55.0, damping = 0.05 }, { direction = [-0.3, "
      "1.0, 0.0], stiffness = \"50 N/um\" }]\n"
      "[machine_override.inertial_deflection]\nXX = { gain_um_per_m_s2 = 1.0, frequency_Hz = 55.0, "
      "damping = 0.05 }\nYX = { gain_um_per_m_s2 = 0.2 }\nYY = { gain_um_per_m_s2 = 1.2, "
      "frequency_Hz = 45.0, damping = 0.04, along = \"Z\", slope_um_per_m_s2_per_m = -1.0 }\n"
      "[machine_override.axis.X]\nmachine_bed = { mass = 5500.0, frequency_Hz = 18.0, damping = "
      "0.04 }\n"
      "[machine_override.heat]\nstart_degC = 24.0\nsurroundings = { room = { mean_degC = 20.0 } }\n"
      "[machine_override.heat.body.head]\ncapacity_J_per_K = 5e4\nconductance_W_per_K = { room = "
      "10.0 }\nerrors_per_K = { EYZ = { constant_um = -0.8 }, EXX = { um_per_m = 10.0 } }\n"
      "[errors.measured]\nEXX = { um_per_m = 40.0 }\nEYX = { harmonic = { amplitude_um = 12.0, "
      "period_mm = 50.0 }, grid = { axes = \"XZ\", at_mm = [[-400, 0, 400], [-400, 0, 400]], "
      "value_um = [[0, 5, 2], [1, -4, 3], [2, 6, -8]] } }\n"
      "[errors.identified]\nEXX = { um_per_m = 36.0 }\nEYX = { harmonic = { amplitude_um = 10.0, "
      "period_mm = 50.0 } }\n"
      "[part]\n[[part.stock]]\nbox = { from_mm = [-20.0, -20.0, -20.0], to_mm = [60.0, 60.0, 0.0] "
      "}\n[[program.tool]]\nnumber = 1\nlength_mm = 110.0\ndiameter_mm = 8.0\nteeth = 4\n"
      "[cutting]\nmaterial = \"42CrMo4\"\nforce = \"instantaneous\"\n"
      "[record]\nperiod_ms = 0.2\n"
      "[[case]]\nname = \"one\"\n[[case.strategy]]\ntype = \"gcode\"\nmodel = \"identified\"\n";
  const model::Scenario scenario = small_scenario(
      "G17 G21 G40 G90 G94 G64 P0.002\nT1 M6\nG43 H1\nS4775 M3\nG0 X-30 Y0\nZ-1\n(MSG, slot)\nG1 "
      "X10 "
      "F1394\nG3 X20 Y10 J10\nG1 Y20\n(MSG, leave)\nG1 Y30\nM30\n",
      toml);
  const std::vector<std::string> also = {"tool_deviation"};
  const auto budgets = find_budgets(scenario, budget_quantities(scenario, also, {"slot"}));
  ASSERT_EQ(budgets.size(), 3U);
  for (const Budget& budget : budgets) {
    ASSERT_EQ(budget.note, "");
    expect_sum(budget);
    const std::string axis(1, budget.quantity.axis);
    if (!budget.pairs.empty()) expect_sum_of_shares(budget);
    const double left =
        budget.has_large_remainder() ? budget.unexplained.rms : budget.remainder.rms;
    RecordProperty(axis + "_residual_um", fmt::format("{:.3f}", budget.residual.rms));
    RecordProperty(axis + "_remainder_um", fmt::format("{:.3f}", budget.remainder.rms));
    RecordProperty(axis + "_left_um", fmt::format("{:.4f}", left));
    EXPECT_LE(left, std::max(0.1 * budget.residual.rms, 0.05)) << axis;
  }
}

// Without lag: 144 um identified, of which the limit lets 100 pass, where 120 are true. The wrong
// identification alone does no harm, and without it the limit would take 20 um; without the limit
// it adds 24. So the limit has -20 - 24 = -44 and the identification 0, and 24 are both together.
TEST(Budget, LeavesWhatCausesDoTogetherInTheRemainder) {
  const Budget budget = budget_of(
      root("constant_um = 120.0", "[errors.identified]\nEYX = { constant_um = 144.0 }\n") +
      one_case("type = \"feedback\"\nmodel = \"identified\"\nmax_um = 100.0\n",
               "servo = \"ideal\"\n"));
  constexpr double kSteps = 0.1;  // um, of encoders and more than these
  EXPECT_NEAR(budget.residual.at_place, -20.0, kSteps);
  EXPECT_NEAR(part(budget, Cause::saturation).at_place, -44.0, kSteps);
  EXPECT_NEAR(part(budget, Cause::identification).at_place, 0.0, kSteps);
  EXPECT_NEAR(budget.remainder.at_place, 24.0, kSteps);
  // the largest pair is all of it
  ASSERT_FALSE(budget.pairs.empty());
  EXPECT_EQ(budget.pairs[0].causes, (std::array{Cause::saturation, Cause::identification}));
  EXPECT_NEAR(budget.pairs[0].at_place, 24.0, kSteps);
  EXPECT_LE(budget.unexplained.rms, 1e-6);
  // and half of it goes to either: -44 + 12 and 0 + 12
  EXPECT_NEAR(part(budget, Cause::saturation).share.at_place, -32.0, kSteps);
  EXPECT_NEAR(part(budget, Cause::identification).share.at_place, 12.0, kSteps);
  expect_sum_of_shares(budget);
}

// The share is what a cause adds, averaged over all orders in which causes are added (Shapley):
// computed here of the four runs that two causes have.
TEST(Budget, SharesAreTheMeanOverAllOrdersOfTheCauses) {
  const auto left = [](const char* known, const char* limit) {
    const std::string toml =
        root("constant_um = 120.0",
             std::string("[errors.identified]\nEYX = { constant_um = ") + known + " }\n") +
        one_case(std::string("type = \"feedback\"\nmodel = \"identified\"\n"
                             "max_um = ") +
                     limit + "\n",
                 "servo = \"ideal\"\n");
    const Budget budget = budget_of(toml);
    return budget.residual.at_place;
  };
  const double none = left("120.0", "1000.0"), limited = left("120.0", "100.0");
  const double wrong = left("144.0", "1000.0"), both = left("144.0", "100.0");
  const double of_limit = 0.5 * ((limited - none) + (both - wrong));
  const double of_model = 0.5 * ((wrong - none) + (both - limited));
  const Budget budget = budget_of(
      root("constant_um = 120.0", "[errors.identified]\nEYX = { constant_um = 144.0 }\n") +
      one_case("type = \"feedback\"\nmodel = \"identified\"\nmax_um = 100.0\n",
               "servo = \"ideal\"\n"));
  constexpr double kSteps = 0.1;  // um, of encoders and more than these
  EXPECT_NEAR(part(budget, Cause::saturation).share.at_place, of_limit, kSteps);
  EXPECT_NEAR(part(budget, Cause::identification).share.at_place, of_model, kSteps);
}

// The tip stands while C turns under tool-centre-point control: arc length does not tell where. The
// centre of C is 10 um off, so X of the workpiece is off by 10 (1 - cos C) um.
TEST(Budget, ComparesByTheTurnWhereTheTipStands) {
  const Budget budget = budget_of(
      "machine_errors = \"machine\"\n[errors.machine]\nEX0C = \"10 um\"\n[[program.tool]]\nnumber "
      "= "
      "1\nlength_mm = 110.0\n[[case]]\nname = \"one\"\n"
      "servo = \"ideal\"\n" +
          quantity("tool_deviation", 'X', "turn"),
      "G17 G90 G94 G64 P0.0002 T1 M6\nG43.4 H1\nG0 X30 Y0 Z-10 C0\nF3600\nG1 C10\n(MSG, turn)\nG1 "
      "C350\nM30\n");
  EXPECT_EQ(budget.s.all().front(), budget.s.all().back());
  EXPECT_NEAR(part(budget, Cause::uncorrected).at_place, 20.0, 0.01);
  EXPECT_LT(largest(part(budget, Cause::interpolation)), 0.2);  // um, P0.0002
  expect_nothing_else(budget, {Cause::uncorrected, Cause::interpolation}, 0.01);
}

TEST(Budget, RefusesASectionThatTheProgramLacks) {
  const model::Scenario scenario = small_scenario(kProgram, "[[case]]\nname = \"one\"\n");
  const std::vector<std::string> also = {"tool_deviation"};
  auto quantities = budget_quantities(scenario, also, {"flonk"});
  for (model::QuantitySpec& one : quantities) one.sections_place = {"--section"};
  try {
    find_budgets(scenario, quantities);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "--section: error: small.ngc has no section 'flonk'; did you mean 'flank'?");
  }
}

TEST(Budget, SaysWhyThereIsNone) {
  const model::Scenario scenario = small_scenario(
      kProgram,
      root("polynomial_um = [0.0, 10.0]") +
          one_case(kTableOverX, "[case.machine_override.nc]\nfollowing_error_limit_mm = 1e-6\n"));
  const auto budgets = find_budgets(scenario, budget_quantities(scenario));
  ASSERT_EQ(budgets.size(), 1U);
  EXPECT_TRUE(budgets[0].note.starts_with("case one stopped: axis ")) << budgets[0].note;
}

}  // namespace
}  // namespace servomill::sim::run::budget_test
