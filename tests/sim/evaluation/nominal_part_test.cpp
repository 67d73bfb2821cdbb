/// A probed part aligned with the mesh of the nominal one: from the scenario to the result file.
#include "sim/evaluation/nominal_part.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "plant/vocabulary/units.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/records/input_file.h"
#include "sim/run/run_output.h"
#include "sim/run/store.h"
#include "sim/run/stored_run.h"
#include "sim/system/base64.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::evaluation::nominal_part_test {
namespace {

using Eigen::Vector3d;

constexpr double kPerfect = 0.1;  // um: what a perfect machine may leave

// Along the side at Y0, up the side at X100 and over the top at Z0 of a block that ends at X-20,
// Y70 and Z-10.
constexpr const char* kProgram =
    "G17 G21 G40 G90 G94 G64 P0.0001\nT1 M6\nG43 H1\nF3000\n"
    "G0 X-10 Y-4 Z20\nG1 Z-10\nG1 X110\nG0 X104 Y-10\nG1 Y60\n"
    "G0 Z20\nG0 X-10 Y3\nG1 Z0\nG1 X110\nG0 Z20\nM2\n";
constexpr const char* kTool =
    "[[program.tool]]\nnumber = 1\nlength_mm = 110.0\ndiameter_mm = 8.0\nflute_length_mm = 25.0\n";
constexpr const char* kProbes =
    "[[probe]]\nname = \"flank\"\nline = { from_mm = [0.0, 0.0, -5.0], to_mm = [98.0, 0.0, -5.0], "
    "normal = [0, -1, 0], points = 50 }\n"
    "[[probe]]\nname = \"side\"\nline = { from_mm = [100.0, 2.0, -5.0], to_mm = [100.0, 52.0, "
    "-5.0], normal = [1, 0, 0], points = 50 }\n"
    "[[probe]]\nname = \"plane\"\nplane = { corner_mm = [0.0, 1.0, 0.0], u_mm = [98.0, 0.0, 0.0], "
    "v_mm = [0.0, 5.0, 0.0], normal = [0, 0, 1], points = [11, 3] }\n";

metrology::Triangles block(const Vector3d& from, const Vector3d& to) {
  metrology::Triangles out;
  for (int i = 0; i < 8; ++i) {
    out.corners.emplace_back((i & 1) ? to.x() : from.x(), (i & 2) ? to.y() : from.y(),
                             (i & 4) ? to.z() : from.z());
  }
  out.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return out;
}

const metrology::Triangles& the_block() {
  static const metrology::Triangles kBlock =
      block(Vector3d(-20.0, 0.0, -10.0) * mm, Vector3d(100.0, 70.0, 0.0) * mm);
  return kBlock;
}

std::string part(const metrology::Triangles& triangles) {
  return fmt::format("[part]\nstl = \"block.stl\"\nstl_base64 = \"{}\"\n",
                     system::base64(metrology::binary_stl(triangles)));
}

model::Scenario milled(const std::string& errors, const std::string& part_and_more) {
  return small_scenario(kProgram, "machine_errors = \"machine\"\n" + std::string(kTool) +
                                      "[errors.machine]\n" + errors + part_and_more +
                                      "[[case]]\nname = \"one\"\nservo = \"ideal\"\n" + kProbes +
                                      "[[quantity]]\nname = \"distortion\"\n");
}

run::RunOutput run(const model::Scenario& scenario) {
  run::RunControl control;
  control.threads = 1;
  return run::run_scenario(scenario, control);
}

std::string faults(const std::string& errors, const std::string& part_and_more) {
  try {
    milled(errors, part_and_more);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(NominalPart, IsFoundAgainWhereTheWholePartIsShiftedAndTurned) {
  // X reads 20 um too little everywhere, Z 7 um too much; Y leans by 100 urad with X
  const std::string shifted =
      "EXX = { polynomial_um = [20.0] }\nEZX = { polynomial_um = [-7.0] }\n";
  const model::Scenario scenario = milled(shifted, part(the_block()));
  const run::RunOutput output = run(scenario);
  ASSERT_TRUE(output.cases[0].part_fit);
  const metrology::BestFit& fit = output.cases[0].part_fit->fit;
  EXPECT_LT(output.comparison[0].value, kPerfect);
  EXPECT_LT(fit.rms / um, kPerfect);
  EXPECT_LT((fit.motion.translation() / um - Vector3d(-20.0, 0.0, 7.0)).norm(), kPerfect);
  EXPECT_LT(largest_distance(scenario.probes, *scenario.part->mesh) / um, 1e-3);
}

// The same number as from the planes through the nominal points, for both sides are planes: the
// squareness of 100 urad that a motion shares out between sides of 98 and 50 mm.
TEST(NominalPart, GivesTheDistortionOfItsFaces) {
  const std::string leaning = "EC0Y = \"100 urad\"\n";
  const run::RunOutput mesh = run(milled(leaning, part(the_block()))),
                       faces = run(milled(leaning, ""));
  EXPECT_NEAR(mesh.comparison[0].value, faces.comparison[0].value, 0.01);
  // each line with 50 points: the sum of squares 98^2 a^2 + 50^2 b^2, a - b = 100 urad, is least
  // for b = -79.3 urad, and the ends of the line of 50 mm are off by half of that
  EXPECT_NEAR(mesh.comparison[0].value, 25.0e-3 * 79.3, kPerfect);
  EXPECT_FALSE(faces.cases[0].part_fit);
}

TEST(NominalPart, IsInTheResolvedScenarioAndTheResultFile) {
  const model::Scenario scenario = milled("EC0Y = \"100 urad\"\n", part(the_block()));
  const model::Scenario again = input::read_resolved_scenario(scenario.resolved, "again");
  ASSERT_TRUE(again.part);
  EXPECT_EQ(again.part->file, "block.stl");
  EXPECT_EQ(again.part->bytes, scenario.part->bytes);
  EXPECT_EQ(again.resolved, scenario.resolved);

  const run::RunOutput output = run(scenario);
  const auto folder = std::filesystem::path(testing::TempDir()) / fmt::format("stl_{}", getpid());
  std::filesystem::create_directories(folder);
  const std::string path = folder / "part.h5";
  run::RunStore store(path, false, scenario);
  store.add(output.cases[0]);
  store.commit(output.comparison);
  const run::StoredRun back = run::read_run(path);
  EXPECT_NEAR(compare(back.quantities, back.cases)[0].value, output.comparison[0].value, 1e-6);
  const records::InputFile file(path);
  const auto places = file.values("/cases/one/probes/side/aligned_position");
  const auto deviations = file.values("/cases/one/probes/side/aligned_deviation");
  std::filesystem::remove_all(folder);
  ASSERT_EQ(places.size(), 150U);
  double largest = 0.0;
  for (std::size_t i = 0; i < places.size(); i += 3) {
    EXPECT_NEAR(places[i], 100.0, 1e-9);      // mm, on the face
    EXPECT_NEAR(deviations[i + 1], 0, 1e-6);  // um, along its normal alone
    largest = std::max(largest, std::abs(deviations[i]));
  }
  EXPECT_NEAR(largest, output.comparison[0].value, 1e-6);
}

TEST(NominalPart, MustHaveTheProbesOnIt) {
  const metrology::Triangles low =
      block(Vector3d(-20.0, 0.0, -10.0) * mm, Vector3d(100.0, 70.0, -0.12) * mm);
  const metrology::Triangles just =
      block(Vector3d(-20.0, 0.0, -10.0) * mm, Vector3d(100.0, 70.0, -0.09) * mm);
  const std::string file = SERVOMILL_SOURCE_DIR "/scenarios/small.toml";
  const std::string found = faults("", part(low));
  EXPECT_NE(found.find("probe 'plane': 33 of 33 points are not on the part 'block.stl', the first, "
                       "X0 Y1 Z0, is 0.12 mm off; must be <= 0.1 mm"),
            std::string::npos)
      << found;
  EXPECT_EQ(faults("", part(just)), "no error");
  EXPECT_NE(faults("", part(the_block()) +
                           "[[probe]]\nname = \"in\"\npoints_mm = [[50, 20, 0, 0, 0, -1]]\n")
                .find("probe 'in': 1 of 1 points have normals that disagree with the part "
                      "'block.stl', the first at X50 Y20 Z0, where its normal is (0, 0, 1); "
                      "normals must point out of the part"),
            std::string::npos);
}

TEST(NominalPart, MustFaceAsTheProbesDo) {
  const auto found = [](const std::string& point) {
    return faults("", part(the_block()) + "[[probe]]\nname = \"p\"\npoints_mm = [" + point + "]\n");
  };
  EXPECT_EQ(found("[100, 20, -5, 1, 0, 0]"), "no error");
  EXPECT_NE(found("[100, 20, -5, 0, 1, 0]").find("disagree with the part"), std::string::npos);
  // on the edge between two faces either of them, but not into the body
  EXPECT_EQ(found("[100, 0, -5, 1, 0, 0]"), "no error");
  EXPECT_EQ(found("[100, 0, -5, 0, -1, 0]"), "no error");
  EXPECT_NE(found("[100, 0, -5, -1, 0, 0]").find("disagree with the part"), std::string::npos);
}

// Chords in place of arcs are as good as their distance.
TEST(NominalPart, NeedsAProbeToBeOfAnyUse) {
  try {
    small_scenario(kProgram, kTool + part(the_block()) + "[[case]]\nname = \"one\"\n");
    ADD_FAILURE() << "was ignored";
  } catch (const InputError& error) {
    const std::string all = error.what();
    EXPECT_EQ(all.substr(all.find(": error: ")),
              ": error: part.stl = \"block.stl\"; is the reference for the alignment of probed "
              "points: it needs a [[probe]]");
  }
}

TEST(NominalPart, SaysHowFarItsFacetsAreOff) {
  const metrology::Triangles low =
      block(Vector3d(-20.0, 0.0, -10.0) * mm, Vector3d(100.0, 70.0, -0.005) * mm);
  const run::RunOutput output = run(milled("", part(low)));
  ASSERT_FALSE(output.cases[0].notes.empty());
  EXPECT_EQ(
      output.cases[0].notes.back(),
      "warning: case one: nominal points of the probes are up to 5 um off 'block.stl' (facets in "
      "place of curved faces, or another part); distances after best fit include this");
}

TEST(NominalPart, SaysWhatLeavesItFree) {
  model::Scenario scenario = milled("", part(the_block()));
  scenario.probes.pop_back();  // the plane
  scenario.quantities.clear();
  const run::RunOutput output = run(scenario);
  EXPECT_FALSE(output.cases[0].part_fit);
  ASSERT_FALSE(output.cases[0].notes.empty());
  EXPECT_TRUE(output.cases[0].notes.back().starts_with(
      "warning: case one: best fit to 'block.stl': the points do not determine the position of the "
      "part: it is insensitive to "))
      << output.cases[0].notes.back();
}

}  // namespace
}  // namespace servomill::sim::evaluation::nominal_part_test
