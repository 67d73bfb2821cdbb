/// Error budgets: causes with a known answer each get theirs, and no more.
#include "sim/run/budget.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>
#include <utility>

#include "plant/vocabulary/units.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::budget_test {
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

std::string quantity(const std::string& name, char axis, const std::string& section = "flank") {
  return fmt::format(
      "[[quantity]]\nname = \"{}\"\naxis = \"{}\"\nsections = [\"{}\"]\ncases = [\"one\"]\n", name,
      axis, section);
}

const std::string kTableOverX =
    "type = \"table\"\nbase_axis = \"X\"\nfrom_mm = -20.0\nto_mm = 100.0\nmodel = \"imposed\"\n";

std::string one_case(const std::string& strategy, const std::string& more = "") {
  return "[[case]]\nname = \"one\"\n" + more + "[[case.strategy]]\naction = \"impose\"\n" +
         strategy + quantity("imposed_error_residual", 'Y') + "baseline = \"nominal\"\n";
}

// Parts and remainder make the residual, at each place.
void expect_sum(const Budget& budget) {
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

Budget budget_of(const std::string& toml, const char* program = kProgram) {
  const Scenario scenario = small_scenario(program, toml);
  const auto budgets = find_budgets(scenario, budget_quantities(scenario));
  EXPECT_EQ(budgets.size(), 1U);
  EXPECT_EQ(budgets.front().note, "");
  expect_sum(budgets.front());
  return budgets.front();
}

const BudgetPart& part(const Budget& budget, Cause cause) {
  return budget.parts[static_cast<std::size_t>(cause)];
}

double largest(const BudgetSignal& signal) {
  double out = 0.0;
  for (const double v : signal.signal.all()) out = std::max(out, std::abs(v));
  return out;
}

// All but some.
void expect_nothing_else(const Budget& budget, const std::vector<Cause>& but, double least) {
  for (const BudgetPart& one : budget.parts) {
    if (std::find(but.begin(), but.end(), one.cause) != but.end()) continue;
    EXPECT_LT(largest(one), least) << info_of(one.cause).name;
  }
  EXPECT_LT(largest(budget.remainder), least);
}

// A table behind the feed-forward tap, of a straight error curve: behind by slope v / Kv.
TEST(Budget, OfLagAlone) {
  constexpr double kSlope = 10.0;  // um/mm
  const Budget budget = budget_of(root("polynomial_um = [0.0, 10.0]") + one_case(kTableOverX));
  const double lag = kSlope * kFeed / kKv;  // 3.87 um
  constexpr double kSome = 0.01;            // share; the path is a little slower at the ends
  EXPECT_NEAR(part(budget, Cause::lag).at_place, -lag, kSome * lag);
  EXPECT_NEAR(part(budget, Cause::lag).rms, lag, 2.0 * kSome * lag);
  EXPECT_NEAR(budget.residual.at_place, -lag, kSome * lag);
  expect_nothing_else(budget, {Cause::lag}, 0.03 * lag);  // encoder steps and path tolerance
}

TEST(Budget, OfADelayAlone) {
  constexpr double kSlope = 10.0;  // um/mm
  const Budget budget =
      budget_of(root("polynomial_um = [0.0, 10.0]") +
                one_case(kTableOverX + "dead_time_ms = 20.0\ntime_constant_ms = 30.0\n",
                         "servo = \"ideal\"\n"));
  const double behind = kSlope * kFeed * 50e-3;  // 11.6 um
  EXPECT_NEAR(part(budget, Cause::delay).at_place, -behind, 0.01 * behind);
  expect_nothing_else(budget, {Cause::delay}, 0.01 * behind);
}

// EYX = 0.1 um/mm^2 x^2 / 2: the chord of an interval is off by spacing^2 / 8 times the curvature.
TEST(Budget, OfTheSpacingOfATableAlone) {
  const Budget budget =
      budget_of(root("polynomial_um = [0.0, 0.0, 0.05]") +
                one_case(kTableOverX + "spacing_mm = 6.5536\n", "servo = \"ideal\"\n"));
  const double chord = 6.5536 * 6.5536 / 8.0 * 0.1;  // 0.537 um
  EXPECT_NEAR(part(budget, Cause::table).at_place, chord, 0.01 * chord);
  EXPECT_NEAR(part(budget, Cause::table).at_place, budget.residual.at_place, 1e-3 * chord);
  EXPECT_NEAR(part(budget, Cause::table).rms, std::sqrt(8.0 / 15.0) * chord, 0.02 * chord);
  expect_nothing_else(budget, {Cause::table}, 0.01 * chord);
}

// Identified 10.5 um/mm in place of 10, once by each way of correcting.
TEST(Budget, OfAnIdentificationErrorAlone) {
  const std::string errors = root("polynomial_um = [0.0, 10.0]",
                                  "[errors.identified]\nEYX = { polynomial_um = [0.0, 10.5] }\n");
  const std::string table = "type = \"table\"\nbase_axis = \"X\"\nfrom_mm = -20.0\nto_mm = 100.0\n";
  for (const std::string& type : {table, std::string("type = \"feedback\"\nmax_um = 2000.0\n"),
                                  std::string("type = \"gcode\"\n")}) {
    const Budget budget =
        budget_of(errors + one_case(type + "model = \"identified\"\n", "servo = \"ideal\"\n"));
    const double wrong = 0.5 * 80.0;  // um, where the section ends
    EXPECT_NEAR(part(budget, Cause::identification).at_place, wrong, 0.01 * wrong) << type;
    expect_nothing_else(budget, {Cause::identification}, 0.01 * wrong);
  }
}

// The origin of a rewritten program counts as identification: 10 um/mm, 7 mm away.
TEST(Budget, OfAnotherOriginAlone) {
  const Budget budget =
      budget_of(root("polynomial_um = [0.0, 10.0]") +
                one_case("type = \"gcode\"\nmodel = \"imposed\"\nrewrite_origin = \"program\"\n",
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

// A following error begins behind the interpolation. Without feed-forward it is v / Kv. Blocks of
// 1 mm that take 62.5 ms each make v = 16 mm/s of 20: less of it, but none of it is theirs.
TEST(Budget, OfAFollowingErrorHasNoPartForTheInterpolation) {
  std::string program = "G17 G21 G40 G90 G94 G64 P0.0002\nG1 X20 F1200\n";
  for (int x = 21; x <= 40; ++x) {
    program += fmt::format("G1 X{}\n{}", x, x == 24 ? "(MSG, flank)\n" : "");  // slow since long
  }
  program += "(MSG, leave)\nG1 X50\nM30\n";
  const Budget budget = budget_of(
      "[machine_override.nc]\nKv = \"60 1/s\"\nvelocity_feed_forward = 0.0\n"
      "acceleration_feed_forward = 0.0\nblock_processing_time_ms = 62.5\n[[case]]\nname = "
      "\"one\"\n" +
          quantity("following_error", 'X'),
      program.c_str());
  const double lag = 1e3 * 16.0 / kKv;  // 267 um
  constexpr double kSome = 1e-3;        // share
  EXPECT_NEAR(budget.residual.at_place, lag, kSome * lag);
  EXPECT_NEAR(part(budget, Cause::lag).at_place, lag, kSome * lag);
  EXPECT_EQ(largest(part(budget, Cause::interpolation)), 0.0);
  expect_nothing_else(budget, {Cause::lag}, kSome * lag);
}

// Coulomb friction F against a velocity loop without integral part: at constant speed the motor
// gives r F = Kp Kv e / r. With full velocity feed-forward, and nothing viscous, that is all.
TEST(Budget, OfFrictionAlone) {
  constexpr double F = 450.0, r = 20e-3 / (2.0 * std::numbers::pi);  // N, m/rad
  constexpr double J = 9.6e-3 + 750.0 * r * r;                       // kg m^2
  const double behind = r * r * F / (200.0 * J * kKv) / um;          // Kp = 200 rad/s J: 22.1 um
  const std::string toml =
      "[machine_override]\nfriction_model = \"set_valued\"\n[machine_override.nc]\n"
      "Kv = \"60 1/s\"\n[machine_override.axis.X]\nvelocity_reset_time_ms = 0.0\n"
      "motor_viscous_friction = 0.0\nslide_viscous_friction = 0.0\n[[case]]\nname = \"one\"\n";
  const Budget following = budget_of(toml + quantity("following_error", 'X'));
  const Budget deviation = budget_of(toml + quantity("tool_deviation", 'X'));
  EXPECT_NEAR(part(following, Cause::friction).at_place, behind, 1e-3 * behind);
  EXPECT_NEAR(part(deviation, Cause::friction).at_place, -behind, 1e-3 * behind);
  for (const Budget& budget : {following, deviation}) {
    EXPECT_NEAR(part(budget, Cause::friction).rms, behind, 1e-3 * behind);
    expect_nothing_else(budget, {Cause::friction}, 2e-3 * behind);  // steps of encoders
  }
}

// A gap that the motor's encoder cannot see is what the slide loses between there and back.
TEST(Budget, OfBacklashAlone) {
  constexpr double kGap = 20.0;  // um
  constexpr const char* kThereAndBack =
      "G17 G21 G40 G90 G94 G64 P0.0002\nG1 X20 F1394\n(MSG, there)\nG1 X60\n(MSG, turn)\nG1 X80\n"
      "G1 X60\n(MSG, back)\nG1 X20\n(MSG, leave)\nG1 X10\nM30\n";
  const auto in = [&](const char* section) {
    const Budget budget = budget_of(
        "[machine_override.nc]\nposition_feedback = \"motor\"\n[machine_override.axis.X]\n"
        "backlash = \"20 um\"\n[[case]]\nname = \"one\"\n" +
            quantity("tool_deviation", 'X', section),
        kThereAndBack);
    expect_nothing_else(budget, {Cause::friction, Cause::lag}, 2e-3 * kGap);
    return part(budget, Cause::friction).at_place;
  };
  EXPECT_NEAR(in("back") - in("there"), kGap, 1e-3 * kGap);
}

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
  const double residual = budgets[0].residual.at_place;
  EXPECT_GT(std::abs(residual), 1.0);
  EXPECT_NEAR(part(budgets[0], Cause::cutting).at_place, residual, 1e-6);
  expect_nothing_else(budgets[0], {Cause::cutting}, 1e-6);
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
  const Scenario scenario = small_scenario(kFlank, toml);
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

// Deviation of the tool and following error belong to every case, asked for or not.
TEST(Budget, IsThereForCasesThatNobodyAsksAbout) {
  const Scenario scenario =
      small_scenario(kProgram,
                     "[[case]]\nname = \"one\"\n[[case]]\nname = \"two\"\n"
                     "[[quantity]]\nname = \"contour_error\"\n"
                     "[[quantity]]\nname = \"following_error\"\naxis = \"X\"\n"
                     "cases = [\"two\"]\n");
  EXPECT_EQ(budget_quantities(scenario).size(), 1U);
  const std::vector<std::string> both = {"tool_deviation", "following_error"};
  const auto quantities = budget_quantities(scenario, both, {"flank"});
  ASSERT_EQ(quantities.size(), 1U + 2U * 3U);  // as it is; two cases of X, Y, Z
  for (const QuantitySpec& one : quantities) {
    EXPECT_EQ(one.sections, std::vector<std::string>{"flank"});
  }
}

TEST(Budget, RefusesASectionThatTheProgramLacks) {
  const Scenario scenario = small_scenario(kProgram, "[[case]]\nname = \"one\"\n");
  const std::vector<std::string> also = {"tool_deviation"};
  auto quantities = budget_quantities(scenario, also, {"flonk"});
  for (QuantitySpec& one : quantities) one.sections_place = {"--section"};
  try {
    find_budgets(scenario, quantities);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "--section: error: small.ngc has no section 'flonk'; did you mean 'flank'?");
  }
}

TEST(Budget, SaysWhyThereIsNone) {
  const Scenario scenario = small_scenario(
      kProgram,
      root("polynomial_um = [0.0, 10.0]") +
          one_case(kTableOverX, "[case.machine_override.nc]\nfollowing_error_limit_mm = 1e-6\n"));
  const auto budgets = find_budgets(scenario, budget_quantities(scenario));
  ASSERT_EQ(budgets.size(), 1U);
  EXPECT_TRUE(budgets[0].note.starts_with("case one stopped: axis ")) << budgets[0].note;
}

}  // namespace
}  // namespace servomill::sim::budget_test
