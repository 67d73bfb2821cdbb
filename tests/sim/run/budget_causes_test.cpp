/// Causes with a known answer each get theirs, and no more.
#include "sim/run/budget_causes.h"

#include <numbers>

#include "plant/vocabulary/parameters.h"
#include "sim/model/scenario.h"
#include "strategies/entry.h"
#include "tests/sim/run/small_budget.h"

namespace servomill::sim::run::budget_causes_test {
namespace {

using namespace small_budget;

// A table behind the feed-forward tap, of a straight error curve: behind by slope v / Kv.
TEST(BudgetCauses, OfLagAlone) {
  constexpr double kSlope = 10.0;  // um/mm
  const Budget budget = budget_of(root("polynomial_um = [0.0, 10.0]") + one_case(kTableOverX));
  const double lag = kSlope * kFeed / kKv;  // 3.87 um
  constexpr double kSome = 0.01;            // share; the path is a little slower at the ends
  EXPECT_NEAR(part(budget, Cause::lag).at_place, -lag, kSome * lag);
  EXPECT_NEAR(part(budget, Cause::lag).rms, lag, 2.0 * kSome * lag);
  EXPECT_NEAR(budget.residual.at_place, -lag, kSome * lag);
  expect_nothing_else(budget, {Cause::lag}, 0.03 * lag);  // encoder steps and path tolerance
}

TEST(BudgetCauses, OfADelayAlone) {
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
TEST(BudgetCauses, OfTheSpacingOfATableAlone) {
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
TEST(BudgetCauses, OfAnIdentificationErrorAlone) {
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

// Interpolation is taken away by a chord tolerance a hundredth as large; where a strategy declares
// nothing but the length of its blocks, by a tenth of that: the chord error is its square.
TEST(BudgetCauses, RefineBlocksByTheirToleranceElseByTheirLength) {
  const model::Scenario scenario =
      small_scenario(kProgram, root("polynomial_um = [0.0, 10.0]") +
                                   one_case("type = \"gcode\"\nmodel = \"imposed\"\n"));
  struct Declared {
    std::string key;
    Shortcoming shortcoming;
  };
  const auto refined = [&](const std::vector<Declared>& declared) {
    std::vector<ParameterSpec> specs;
    for (const auto& [key, shortcoming] : declared) {
      specs.push_back({.name = key, .help = "length", .unit = "mm", .shortcoming = shortcoming});
    }
    strategies::Entry entry = *scenario.cases.back().strategies.front().entry;
    entry.parameters = specs;
    model::Scenario own = scenario;
    model::StrategySpec& strategy = own.cases.back().strategies.front();
    strategy.entry = &entry;
    for (const ParameterSpec& spec : specs) strategy.parameters.set(spec.name, 1e-3);
    own = without(own, {Cause::interpolation}, {}, {{"one", {Cause::interpolation}}});
    std::vector<double> out;
    for (const ParameterSpec& spec : specs) {
      out.push_back(own.cases.back().strategies.front().parameters.number(spec.name));
    }
    return out;
  };
  const Declared tolerance{"tolerance_mm", Shortcoming::chord_tolerance};
  const Declared length{"block_mm", Shortcoming::block_length};
  EXPECT_EQ(refined({tolerance, length}), (std::vector<double>{0.01 * 1e-3, 1e-3}));
  EXPECT_EQ(refined({length}), (std::vector<double>{0.1 * 1e-3}));
}

// The origin of a rewritten program counts as identification: 10 um/mm, 7 mm away.
TEST(BudgetCauses, OfAnotherOriginAlone) {
  const Budget budget =
      budget_of(root("polynomial_um = [0.0, 10.0]") +
                one_case("type = \"gcode\"\nmodel = \"imposed\"\nrewrite_origin = \"program\"\n",
                         "servo = \"ideal\"\nwork_offset = { X_mm = 7.0 }\n"));
  EXPECT_NEAR(part(budget, Cause::identification).at_place, -70.0, 0.1);
  expect_nothing_else(budget, {Cause::identification}, 0.1);
}

// 150 um wanted, 100 allowed.
TEST(BudgetCauses, OfSaturationAlone) {
  const Budget budget =
      budget_of(root("constant_um = 150.0") +
                one_case("type = \"feedback\"\nmodel = \"imposed\"\nmax_um = 100.0\n"));
  EXPECT_NEAR(part(budget, Cause::saturation).at_place, -50.0, 0.1);
  expect_nothing_else(budget, {Cause::saturation}, 0.1);
}

// Chords of 4 mm at a curvature of 0.1 um/mm^2, which the tolerance allows.
TEST(BudgetCauses, OfChordsAlone) {
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
TEST(BudgetCauses, OfAFollowingErrorHasNoPartForTheInterpolation) {
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
TEST(BudgetCauses, OfFrictionAlone) {
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
TEST(BudgetCauses, OfBacklashAlone) {
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

// An ideal servo stands where the NC wants it, but the structure gives way to the cut.
TEST(BudgetCauses, OfTheCutAlone) {
  const model::Scenario scenario = small_scenario(
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

// An ideal servo is where the NC wants it, but the structure gives way to its acceleration.
TEST(BudgetCauses, OfInertiaAlone) {
  const Budget budget = budget_of(
      "[machine_override.inertial_deflection]\nXX = { gain_um_per_m_s2 = 1.0 }\nXY = { "
      "gain_um_per_m_s2 = "
      "0.5, frequency_Hz = 60.0, damping = 0.05 }\n[[case]]\nname = \"one\"\nservo = "
      "\"ideal\"\n" +
          quantity("tool_deviation", 'X'),
      "G17 G21 G90 G94 G64 P0.0002\n(MSG, flank)\nG1 X20 F6000\nG2 X30 Y10 J10\nM30\n");
  EXPECT_GT(std::abs(budget.residual.at_place), 1.0);
  EXPECT_NEAR(part(budget, Cause::inertia).at_place, budget.residual.at_place, 0.01);
  EXPECT_LE(budget.remainder.rms, 1e-3);
}

// A strategy that knows the structure leaves nothing of it; the part is what it leaves.
TEST(BudgetCauses, OfInertiaThatIsCorrected) {
  const auto budget = [](double gain) {
    return budget_of(
        fmt::format("[machine_override.inertial_deflection]\nXX = {{ gain_um_per_m_s2 = 1.0, "
                    "frequency_Hz = 60.0, damping = 0.05 }}\n[[case]]\nname = \"one\"\nservo = "
                    "\"ideal\"\n[[case.strategy]]\ntype = \"inertia\"\nXX_um_per_m_s2 = "
                    "{}\nX_frequency_Hz = 60.0\nX_damping = 0.05\n",
                    gain) +
            quantity("tool_deviation", 'X'),
        "G17 G21 G90 G94 G64 P0.0002\n(MSG, flank)\nG1 X20 F6000\nG2 X30 Y10 J10\nM30\n");
  };
  const double known = part(budget(1.0), Cause::inertia).rms,
               half = part(budget(0.5), Cause::inertia).rms;
  EXPECT_GT(half, 0.1);
  EXPECT_LE(known, 0.02 * half);
  EXPECT_FALSE(part(budget(1.0), Cause::imposed).present);
}

// Contour control follows the path better; it imposes nothing.
TEST(BudgetCauses, OfContourControlHaveNothingImposed) {
  const Budget budget = budget_of(
      "[machine_override.nc]\nvelocity_feed_forward = 0.0\n[[case]]\nname = "
      "\"one\"\n[[case.strategy]]\ntype = \"contour\"\n" +
          quantity("tool_deviation", 'X'),
      "G17 G21 G90 G94 G64 P0.0002\n(MSG, flank)\nG1 X20 F3000\nG2 X30 Y10 J10\nM30\n");
  EXPECT_TRUE(part(budget, Cause::lag).present);
  EXPECT_FALSE(part(budget, Cause::imposed).present);
}

// A bed is in the loops: without it the following error is that of the lag.
TEST(BudgetCauses, OfTheBed) {
  const auto budget = [](const std::string& bed) {
    return budget_of(bed + "[[case]]\nname = \"one\"\n" + quantity("following_error", 'X'),
                     "G21 G90 G94 G61\n(MSG, flank)\nG1 X20 F6000\nG1 X0\nM30\n");
  };
  const Budget with = budget(
      "[machine_override.axis.X]\nmachine_bed = { mass = 2000.0, frequency_Hz = 18.0, damping = "
      "0.04 }\n");
  EXPECT_GT(part(with, Cause::inertia).rms, 0.1);

  EXPECT_FALSE(part(budget(""), Cause::inertia).present);
}

// A head that is 3 K above the reference lowers the tip by 6 um; no servo and no force is in it.
TEST(BudgetCauses, OfHeatAlone) {
  const Budget budget = budget_of(
      "[machine_override.heat]\nstart_degC = 23.0\nsurroundings = { room = { mean_degC = 23.0 } "
      "}\n[machine_override.heat.body.head]\ncapacity_J_per_K = 5e4\nconductance_W_per_K = { room "
      "= 10.0 }\nerrors_per_K = { EZZ = { constant_um = -2.0 } }\n[[case]]\nname = \"one\"\nservo "
      "= \"ideal\"\n" +
          quantity("tool_deviation", 'Z'),
      "G17 G21 G90 G94 G64 P0.0002\n(MSG, flank)\nG1 X20 F6000\nM30\n");
  EXPECT_NEAR(budget.residual.at_place, -6.0, 1e-6);
  EXPECT_NEAR(part(budget, Cause::heat).at_place, -6.0, 1e-6);
  EXPECT_NEAR(budget.group_at_place(CauseGroup::heat).value(), -6.0, 1e-6);
  EXPECT_FALSE(budget.group_at_place(CauseGroup::force).has_value());
  EXPECT_LE(budget.remainder.rms, 1e-6);
}

}  // namespace
}  // namespace servomill::sim::run::budget_causes_test
