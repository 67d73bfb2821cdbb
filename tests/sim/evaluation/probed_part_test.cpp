/// The simulated part on the virtual CMM: from the program to the quantities that are printed.
#include "sim/evaluation/probed_part.h"
#include "sim/evaluation/cutter_path.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/engine/simulate.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepared_case.h"
#include "sim/run/run_output.h"
#include "sim/run/store.h"
#include "sim/run/stored_run.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::evaluation::probed_part_test {
namespace {

constexpr double kPerfect = 0.1;      // um: what a perfect machine may leave
constexpr double kUncertainty = 1.5;  // um, k = 2: that of the CMM of [G]
// um: range of the means of four repetitions at 51 points, six times their standard deviation
constexpr double kNoise = 6.0 * kUncertainty / 2.0 / 2.0;
constexpr double kRounding = 1e-6;  // um: of printed and stored numbers

// A tool of 8 mm along the side at Y0 (flank at Y0, tool below), back over the top, then up the
// side at X100, and around a boss of 20 mm about X50 Y50 at Z3 (on a part whose top is cut to Z0).
constexpr const char* kProgram =
    "G17 G21 G40 G90 G94 G64 P0.0001\nT1 M6\nG43 H1\nF3000\n"
    "G0 X-10 Y-4 Z20\nG1 Z-10\n(MSG, flank)\nG1 X110\n(MSG, side)\nG0 X104 Y-10\nG1 Y60\n"
    "(MSG, plane)\nG0 Z20\nG0 X-10 Y3\nG1 Z0\nG1 X110\nG0 Z20\nG0 X74 Y50\nG1 Z0\n"
    "(MSG, boss)\nG2 I-24\nG0 Z20\nM2\n";

constexpr const char* kTool =
    "[[program.tool]]\nnumber = 1\nlength_mm = 110.0\ndiameter_mm = 8.0\nflute_length_mm = 25.0\n";

constexpr const char* kFlank =
    "[[probe]]\nname = \"flank\"\nline = { from_mm = [0.0, 0.0, -5.0], to_mm = [100.0, 0.0, -5.0], "
    "normal = [0, -1, 0], points = 51 }\n";
constexpr const char* kSide =
    "[[probe]]\nname = \"side\"\nline = { from_mm = [100.0, 0.0, -5.0], to_mm = [100.0, 50.0, "
    "-5.0], normal = [1, 0, 0], points = 51 }\n";
constexpr const char* kPlane =
    "[[probe]]\nname = \"plane\"\nplane = { corner_mm = [0.0, 1.0, 0.0], u_mm = [100.0, 0.0, 0.0], "
    "v_mm = [0.0, 5.0, 0.0], normal = [0, 0, 1], points = [11, 3] }\n";
constexpr const char* kBoss =
    "[[probe]]\nname = \"boss\"\ncircle = { centre_mm = [50.0, 50.0, 3.0], radius_mm = 20.0, "
    "outside = true, points = 24 }\n";

std::string quantity(const std::string& name, const std::string& rest) {
  return "[[quantity]]\nname = \"" + name + "\"\n" + rest + "\n";
}

struct Asked {
  std::string probes, quantities;
  std::string errors;  // of the machine
  std::string root;    // keys of the root
  std::string cases = "[[case]]\nname = \"one\"\nservo = \"ideal\"\n";
};

model::Scenario asking(const Asked& asked) {
  return small_scenario(kProgram, asked.root + "\nmachine_errors = \"machine\"\n" + kTool +
                                      "[errors.machine]\n" + asked.errors + asked.cases +
                                      asked.probes + asked.quantities);
}

run::RunOutput run(const model::Scenario& scenario) {
  run::RunControl control;
  control.threads = 1;
  return run::run_scenario(scenario, control);
}

std::vector<double> values(const std::vector<ComparisonRow>& rows) {
  std::vector<double> out;
  for (const ComparisonRow& row : rows) out.push_back(row.value);
  return out;
}

TEST(ProbedPart, OfAPerfectMachineIsTheNominalOne) {
  std::string quantities;
  for (const char* probe : {"flank", "side", "plane", "boss"}) {
    quantities += quantity("probed_deviation", fmt::format("probe = \"{}\"", probe));
  }
  quantities += quantity("flatness", "probe = \"plane\"") +
                quantity("plane_rotation", "probe = \"plane\"\naxis = \"Y\"") +
                quantity("straightness", "probe = \"flank\"") +
                quantity("roundness", "probe = \"boss\"") +
                quantity("diameter", "probe = \"boss\"") +
                quantity("probed_position", "probe = \"boss\"\naxis = \"X\"") +
                quantity("squareness", "probe = \"flank\"\nto = \"side\"");
  const run::RunOutput output =
      run(asking({std::string(kFlank) + kSide + kPlane + kBoss, quantities, "", ""}));
  ASSERT_EQ(output.comparison.size(), 11U);
  for (const ComparisonRow& row : output.comparison) {
    EXPECT_LT(std::abs(row.value), kPerfect) << row.quantity << " " << row.sections;
    EXPECT_EQ(row.note, "") << row.quantity;
  }
}

// The part shows the errors of the machine: the straightness of X and the squareness of Y
// to X, through a CMM of 1.5 um.
TEST(ProbedPart, ShowsStraightnessAndSquarenessOfTheMachine) {
  const std::string cmm = "[cmm]\nuncertainty_um = 1.5\nprobe_radius_mm = 1.0\nrepetitions = 4\n";
  const run::RunOutput output = run(asking(
      {std::string(kFlank) + kSide,
       quantity("straightness", "probe = \"flank\"") +
           quantity("straightness", "probe = \"side\"") +
           quantity("squareness", "probe = \"flank\"\nto = \"side\""),
       "EYX = { harmonic = { amplitude_um = 20.0, period_mm = 50.0 } }\nEC0Y = \"50 urad\"\n" + cmm,
       ""}));
  const std::vector<double> found = values(output.comparison);
  EXPECT_NEAR(found[0], 40.0, kUncertainty);
  EXPECT_LT(found[1], kNoise);
  // of a line of 50 mm, to which the harmonic, an even number of waves long, adds its own slope
  const double slope = 6.0 * 20.0 / (std::numbers::pi * 2.0 * 0.1);  // um/m
  EXPECT_NEAR(found[2], 50.0 + slope, kUncertainty / 0.05);
}

TEST(ProbedPart, TurnsWithItsWorkOffset) {
  const std::string offset =
      "work_offset = { X_mm = 30.0, Y_mm = -20.0, Z_mm = 5.0, C_deg = 90.0 }\n";
  Asked asked{std::string(kFlank) + kSide + kPlane, "", "EXX = { polynomial_um = [20.0] }\n", ""};
  asked.cases += "[[case]]\nname = \"turned\"\nservo = \"ideal\"\n" + offset;
  asked.quantities = quantity("probed_deviation", "probe = \"flank\"") +
                     quantity("probed_position", "probe = \"side\"\naxis = \"X\"") +
                     quantity("probed_deviation", "probe = \"plane\"");
  // an X scale that is off by 20 um: it is the side that moves, wherever the part stands
  const run::RunOutput output = run(asking(asked));
  ASSERT_EQ(output.comparison.size(), 6U);
  for (const std::size_t i : {0U, 1U, 4U, 5U}) {
    EXPECT_LT(std::abs(output.comparison[i].value), kPerfect) << i;
    EXPECT_EQ(output.comparison[i].note, "");
  }
  EXPECT_NEAR(output.comparison[2].value, 20.0, kPerfect);
  EXPECT_NEAR(output.comparison[3].value, 20.0, kPerfect);
}

TEST(ProbedPart, TellsWhatIsMissed) {
  const std::string beyond =
      "[[probe]]\nname = \"beyond\"\nline = { from_mm = [90.0, 0.0, -5.0], to_mm = [130.0, 0.0, "
      "-5.0], normal = [0, -1, 0], points = 5 }\n";
  const std::string inside =
      "[[probe]]\nname = \"inside\"\npoints_mm = [[50, -4, -5, 0, -1, 0], [50, 30, -5, 0, 0, 1]]\n";
  const run::RunOutput output =
      run(asking({beyond + inside,
                  quantity("straightness", "probe = \"beyond\"") +
                      quantity("probed_deviation", "probe = \"inside\"") +
                      quantity("probed_position", "probe = \"inside\"\naxis = \"Z\""),
                  "", ""}));
  EXPECT_EQ(output.comparison[0].note, "3 of 5 points of 'beyond'");
  EXPECT_LT(output.comparison[0].value, kPerfect);
  const std::string none =
      "no point of 'inside' met a cut surface: check that the tool of case one reaches it";
  for (const std::size_t i : {1U, 2U}) {
    EXPECT_TRUE(std::isnan(output.comparison[i].value));
    EXPECT_EQ(output.comparison[i].note, none);
  }
  std::string notes;
  for (const std::string& note : output.cases[0].notes) {
    notes += note.substr(note.find(": ") + 2) + "\n";
  }
  EXPECT_EQ(notes,
            "warning: case one: 2 of 5 points of probe 'beyond' met no cut surface, first at X120 "
            "Y0 Z-5: no cutter reached this point\n"
            "warning: case one: 1 of 2 points of probe 'inside' met no cut surface, first at X50 "
            "Y30 Z-5: no cutter reached this point\n"
            "warning: case one: 1 of 2 points of probe 'inside' met no cut surface, first at X50 "
            "Y-4 Z-5: the cutter removed everything down to 1 mm (cmm.search_mm) below it\n");
}

// Material that no cutter removed is no part outside of the stock.
TEST(ProbedPart, EndsWhereTheRawPartDoes) {
  const std::string stock =
      "[[part.stock]]\nbox = { from_mm = [0.0, 0.0, -20.0], to_mm = [61.0, 60.0, 5.0] }\n";
  const run::RunOutput output = run(
      asking({std::string(kFlank) + stock, quantity("straightness", "probe = \"flank\""), "", ""}));
  EXPECT_EQ(output.comparison[0].note, "31 of 51 points of 'flank'");  // up to X60
  const std::string& note = output.cases[0].notes.at(0);
  EXPECT_EQ(note.substr(note.find("warning")),
            "warning: case one: 20 of 51 points of probe 'flank' met no cut surface, first at X62 "
            "Y0 Z-5: the stock ([[part.stock]]) does not extend to there");
}

// The errors of the place where the tool stood that cut the point, not where the first one works.
TEST(ProbedPart, IsImposedWithTheToolThatCutIt) {
  constexpr const char* kBore =
      "G17 G21 G40 G90 G94 G64 P0.0001\nF3000\nT2 M6\nG43 H2\nG0 X0 Y0 Z50\nG1 X1\nT1 M6\nG43 "
      "H1\nG0 X50 Y50 Z20\nG1 Z-10\nG1 X56\nG3 I-6\nG1 X50\nG0 Z20\nM2\n";
  const model::Scenario scenario = small_scenario(
      kBore, "imposed = \"wave\"\n" + std::string(kTool) +
                 "[[program.tool]]\nnumber = 2\nlength_mm = 60.0\ndiameter_mm = 25.0\n"
                 "[errors.wave]\nEXX = { polynomial_um = [0.0, 1.0] }\n"
                 "[[case]]\nname = \"one\"\nservo = \"ideal\"\n"
                 "[[case]]\nname = \"wave\"\nservo = \"ideal\"\n[[case.strategy]]\ntype = "
                 "\"gcode\"\nmodel = \"wave\"\naction = \"impose\"\n"
                 "[[probe]]\nname = \"bore\"\ncircle = { centre_mm = [50.0, 50.0, -5.0], "
                 "radius_mm = 10.0, outside = false, points = 24 }\n" +
                 quantity("probed_imposed_residual",
                          "probe = \"bore\"\nbaseline = \"one\"\ncases = [\"wave\"]"));
  // um: chords of the rewritten program and the mark of its way in; 30 with the place of tool 2
  EXPECT_LT(run(scenario).comparison.at(0).value, 0.5);
}

TEST(ProbedPart, HasNoPositionAlongAnAxisThatNoNormalPointsAlong) {
  const run::RunOutput output =
      run(asking({kFlank, quantity("probed_position", "probe = \"flank\"\naxis = \"X\""), "", ""}));
  EXPECT_TRUE(std::isnan(output.comparison[0].value));
  EXPECT_EQ(output.comparison[0].note, "none of its normals has a component along X");
}

// Relative to a base case, point by point, also less what the imposed errors ask for.
TEST(ProbedPart, IsComparedWithABaseCaseAndWithWhatIsImposed) {
  Asked asked{kFlank, "", "", "imposed = \"wave\""};
  asked.errors =
      "EYX = { polynomial_um = [7.0] }\n[errors.wave]\nEYX = { harmonic = { amplitude_um = 20.0, "
      "period_mm = "
      "50.0 } }\n";
  asked.cases +=
      "[[case]]\nname = \"wave\"\nservo = \"ideal\"\n[[case.strategy]]\ntype = "
      "\"feedback\"\nmodel = \"wave\"\naction = \"impose\"\n";
  const std::string common = "probe = \"flank\"\nbaseline = \"one\"\ncases = [\"wave\"]";
  asked.quantities = quantity("probed_deviation", common) + quantity("straightness", common) +
                     quantity("probed_imposed_residual", common) +
                     quantity("probed_deviation", "probe = \"flank\"\ncases = [\"one\"]");
  const std::vector<double> found = values(run(asking(asked)).comparison);
  EXPECT_NEAR(found[0], 20.0, kPerfect);
  EXPECT_NEAR(found[1], 40.0, kPerfect);
  EXPECT_NEAR(found[2], 0.0, kPerfect);
  EXPECT_NEAR(found[3], 7.0, kPerfect);
}

TEST(ProbedPart, ComesBackFromItsFile) {
  const Asked asked{std::string(kFlank) + kPlane,
                    quantity("flatness", "probe = \"plane\"") +
                        quantity("probed_deviation", "probe = \"flank\"\nstatistic = \"rms\""),
                    "[cmm]\nuncertainty_um = 1.5\nrepetitions = 3\n", ""};
  const model::Scenario scenario = asking(asked);
  const run::RunOutput output = run(scenario);
  const auto folder = std::filesystem::path(testing::TempDir()) / fmt::format("part_{}", getpid());
  std::filesystem::create_directories(folder);
  const std::string path = folder / "part.h5";
  run::RunStore store(path, false, scenario);
  store.add(output.cases[0]);
  store.commit(output.comparison);
  const run::StoredRun back = run::read_run(path);
  std::filesystem::remove_all(folder);
  const auto rows = compare(back.quantities, back.cases);
  ASSERT_EQ(rows.size(), 2U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR(rows[i].value, output.comparison[i].value, kRounding);
    EXPECT_GT(rows[i].value, kPerfect);
  }
  // the same again, and with other threads
  run::RunControl control;
  control.threads = 3;
  const run::RunOutput again = run::run_scenario(scenario, control);
  for (std::size_t f = 0; f < 2; ++f) {
    EXPECT_EQ(again.cases[0].probes[f].deviation, output.cases[0].probes[f].deviation);
    EXPECT_EQ(again.cases[0].probes[f].measured, output.cases[0].probes[f].measured);
  }
}

// A part that is only shifted (past the points at its corners) is not distorted; one that is
// sheared by a squareness is, by what no motion takes away.
TEST(ProbedPart, IsDistortedByWhatBestFitLeaves) {
  const std::string probes = std::string(kFlank) + kSide + kPlane;
  const auto distortion = [&](const std::string& errors) {
    const run::RunOutput output = run(asking({probes, quantity("distortion", ""), errors, ""}));
    return output.comparison[0].value;
  };
  EXPECT_LT(distortion("EXX = { polynomial_um = [20.0] }\nEZX = { polynomial_um = [-7.0] }\n"),
            kPerfect);
  // lines of 100 and 50 mm that lean by a and b with a - b = 100 urad: the sum of squares, 100^2
  // a^2
  // + 50^2 b^2 (each as many points), is least for b = -80 urad: 50 mm / 2 * 80 urad = 2 um
  EXPECT_NEAR(distortion("EC0Y = \"100 urad\"\n"), 2.0, kPerfect);
}

// The same with all of the path in memory, with what a few points need and with one point at a
// time.
TEST(ProbedPart, DoesNotDependOnHowMuchOfThePathIsHeld) {
  Asked asked{std::string(kFlank) + kSide + kPlane + kBoss, "", "", "imposed = \"wave\""};
  asked.errors =
      "EYX = { polynomial_um = [7.0] }\n[errors.wave]\nEYX = { harmonic = { "
      "amplitude_um = 20.0, period_mm = 50.0 } }\n";
  const model::Scenario scenario = asking(asked);
  const preparation::PreparedCase prepared(scenario, scenario.cases.front());
  const engine::CaseInputs inputs = prepared.inputs();
  const run::CaseOutput one = run_named_case(scenario, "one");
  const plant::VolumetricModel imposed(one.chain, scenario.errors.at("wave"));
  for (const double radius : {0.0, 1.0 * mm}) {
    metrology::Cmm cmm = scenario.cmm;
    cmm.probe_radius = radius;
    std::vector<metrology::ProbeSpec> plan = scenario.probes;
    if (radius > 0.0) plan.resize(1), plan[0].feature.targets.resize(4);  // a ball takes its time
    const auto probed = [&](const PositionsHeld& held) {
      return probe_part({one.name, one.result.servo, inputs.path, scenario.program.cutters,
                         inputs.tips, one.chain, scenario.program.work_offset, &imposed},
                        plan, cmm, held);
    };
    const ProbedPart whole = probed({});
    for (const PositionsHeld& held : {PositionsHeld{0, 3000}, PositionsHeld{0, 1}}) {
      const ProbedPart parts = probed(held);
      EXPECT_EQ(parts.notes, whole.notes);
      ASSERT_EQ(parts.features.size(), whole.features.size());
      for (std::size_t k = 0; k < whole.features.size(); ++k) {
        const ProbedFeature &some = parts.features[k], &all = whole.features[k];
        ASSERT_EQ(some.deviation.size(), all.deviation.size());
        for (std::size_t i = 0; i < all.deviation.size(); ++i) {
          ASSERT_EQ(std::isnan(some.deviation[i]), std::isnan(all.deviation[i])) << all.name << i;
          if (std::isnan(all.deviation[i])) continue;
          EXPECT_NEAR(some.deviation[i], all.deviation[i], radius > 0.0 ? 50e-9 : 1e-9) << all.name;
          EXPECT_EQ(some.imposed[i], all.imposed[i]) << all.name << " " << i;
        }
      }
    }
  }
}

// Cut at 30 degC and measured at 20 degC, a boss has lost 10 K of expansion, all of its radius: the
// cutter that went round it did not shrink.
TEST(ProbedPart, OfAWarmPartShrinksUntilItIsMeasured) {
  const std::string heat =
      "[machine_override.heat]\nstart_degC = 30.0\nsurroundings = { room = { mean_degC = 30.0 } }\n"
      "part = { body = \"part\", expansion = \"23.5 um/m/K\", fixed_at_mm = [0.0, 0.0, 0.0] }\n"
      "[machine_override.heat.body.part]\ncapacity_J_per_K = 500.0\n"
      "conductance_W_per_K = { room = 4.0 }\n";
  const model::Scenario scenario =
      asking({std::string(kBoss) + kSide + heat,
              quantity("diameter", "probe = \"boss\"") +
                  quantity("probed_position", "probe = \"boss\"\naxis = \"X\"") +
                  quantity("probed_deviation", "probe = \"side\"\nstatistic = \"mean\""),
              "", ""});
  const std::vector<double> found = values(run(scenario).comparison);
  const double shrinks = 235e-6 / (1.0 + 235e-6);
  EXPECT_NEAR(found.at(0), -40e3 * shrinks, kPerfect);
  EXPECT_NEAR(found.at(1), -50e3 * shrinks, kPerfect);
  EXPECT_NEAR(found.at(2), -100e3 * shrinks, kPerfect);
}

// A warm pass over a wall that was finished cold meets nothing: the part is held before the tool,
// so that its wall has grown away from it.
TEST(ProbedPart, IsNotChangedByAWarmPassBesideIt) {
  const std::string program =
      "G17 G21 G40 G90 G94 G64 P0.0001\nT1 M6\nG43 H1\nG0 X104 Y-10 Z20\nG1 Z-10 F3000\nG1 Y60\n";
  const std::string again = "G0 Z20\nG4 P200\nG0 Y-10\nG1 Z-10\nG1 Y60\n";
  const std::string heat =
      "[machine_override.heat]\nstart_degC = 20.0\n"
      "part = { body = \"part\", expansion = \"23.5 um/m/K\", fixed_at_mm = [200.0, 0.0, 0.0] }\n"
      "[machine_override.heat.surroundings.room]\nmean_degC = 20.0\n"
      "[machine_override.heat.body.part]\ncapacity_J_per_K = 500.0\n"
      "conductance_W_per_K = { room = 0.1 }\n[machine_override.heat.source]\n"
      "oven = { body = \"part\", kind = \"constant\", power_W = 100.0 }\n";
  const auto deviation = [&](const std::string& moves, const std::string& more) {
    const model::Scenario scenario = small_scenario(
        moves + "G0 Z20\nM2\n",
        std::string(kTool) + "[[case]]\nname = \"one\"\nservo = \"ideal\"\n" + kSide +
            quantity("probed_deviation", "probe = \"side\"\nstatistic = \"mean\"") + more);
    return values(run(scenario).comparison).at(0);
  };
  EXPECT_NEAR(deviation(program + again, heat), deviation(program, heat), 0.02);
}

}  // namespace
}  // namespace servomill::sim::evaluation::probed_part_test
