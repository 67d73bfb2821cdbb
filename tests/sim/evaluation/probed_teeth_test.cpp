/// Marks of single teeth on a simulated part, on the virtual CMM.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "sim/evaluation/cutter_path.h"
#include "sim/evaluation/probed_part.h"
#include "sim/model/scenario.h"
#include "sim/run/run_output.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::evaluation::probed_teeth_test {
namespace {

constexpr double kFeed = 0.073;  // mm a tooth
constexpr int kPoints = 400;     // of a feed per tooth: a peak is met to 0.5 % of its height

// A wall on the left of the feed, finished by 0.1 mm; probed over three turns.
constexpr const char* kProgram =
    "G17 G21 G90 G94\nT1 M6\nG43 H1\nS4775 M3\nG0 X-6 Y-4\nZ-2\nG1 X14 F1394.3\nM30\n";

model::Scenario wall(const std::string& tool, const std::string& cmm) {
  return small_scenario(
      kProgram,
      "[[program.tool]]\nnumber = 1\nlength_mm = 110.0\ndiameter_mm = 8.0\nteeth = 4\n" + tool +
          "[[part.stock]]\nbox = { from_mm = [0.0, -0.1, -9.0], to_mm = [8.0, 9.0, 0.0] }\n"
          "[cutting]\nmaterial = \"42CrMo4\"\nforce = \"instantaneous\"\nsteps_per_tooth = 15\n" +
          cmm + "[[case]]\nname = \"one\"\nservo = \"ideal\"\n" +
          fmt::format("[[probe]]\nname = \"wall\"\nline = {{ from_mm = [3.0, 0.0, -1.0], to_mm = "
                      "[{}, 0.0, -1.0], normal = [0, -1, 0], points = {} }}\n",
                      3.0 + 12.0 * kFeed, 12 * kPoints + 1));
}

// Deviations along the wall (um).
std::vector<double> probed(const std::string& tool,
                           const std::string& cmm = "[cmm]\ntooth_marks = true\n") {
  run::RunControl control;
  control.threads = 1;
  const run::RunOutput output = run::run_scenario(wall(tool, cmm), control);
  std::vector<double> um;
  for (const double d : output.cases.front().probes.front().deviation) um.push_back(d * 1e6);
  return um;
}

double range(const std::vector<double>& d) {
  return *std::max_element(d.begin(), d.end()) - *std::min_element(d.begin(), d.end());
}

// Largest difference from the wall some teeth later (um).
double change_after(const std::vector<double>& d, int teeth) {
  double largest = 0.0;
  for (std::size_t i = 0; i + static_cast<std::size_t>(teeth * kPoints) < d.size(); ++i) {
    largest = std::max(largest, std::abs(d[i + static_cast<std::size_t>(teeth * kPoints)] - d[i]));
  }
  return largest;
}

// (1 + v / R)^2 of up milling, v = N c / (2 pi) (plant/cutting/tooth_marks.h)
constexpr double kTrochoid = (1.0 + 4.0 * kFeed / (2.0 * std::numbers::pi) / 4.0) *
                             (1.0 + 4.0 * kFeed / (2.0 * std::numbers::pi) / 4.0);
constexpr double kEven = 0.002;  // um: rounding of speed and feed to 1e-4

TEST(ProbedTeeth, leave_waves_of_a_feed_per_tooth_as_high_as_its_square_over_8_R) {
  const std::vector<double> d = probed("");
  EXPECT_NEAR(range(d), kFeed * kFeed / 8.0 / 4.0 * 1e3 / kTrochoid, 0.001) << "0.163 um";
  EXPECT_LE(change_after(d, 1), kEven);
}

TEST(ProbedTeeth, that_run_out_leave_waves_of_a_turn) {
  const std::vector<double> d = probed("runout_um = 10.0\n");
  EXPECT_NEAR(range(d), 16.0 * kFeed * kFeed / 8.0 / 4.0 * 1e3 / kTrochoid, 0.006) << "2.60 um";
  EXPECT_GE(change_after(d, 1), 1.0);
  EXPECT_LE(change_after(d, 4), 0.02);
}

TEST(ProbedTeeth, are_left_out_by_default) { EXPECT_LE(range(probed("", "")), 1e-3); }

std::string refusal(const std::string& cmm, const std::string& force) {
  const std::string scenario =
      "[[program.tool]]\nnumber = 1\nlength_mm = 110.0\ndiameter_mm = 8.0\nteeth = 4\n"
      "[[part.stock]]\nbox = { from_mm = [0.0, -0.1, -9.0], to_mm = [8.0, 9.0, 0.0] }\n"
      "[cutting]\nmaterial = \"42CrMo4\"\n" +
      force + cmm +
      "[[case]]\nname = \"one\"\n[[probe]]\nname = \"wall\"\nline = { from_mm = [3, 0, -1], to_mm "
      "= "
      "[4, 0, -1], normal = [0, -1, 0], points = 3 }\n";
  try {
    small_scenario(kProgram, scenario);
  } catch (const InputError& error) {
    const std::string text = error.what();
    return text.substr(text.find("error: ") + 7);
  }
  return "";
}

TEST(ProbedTeeth, need_the_angle_of_the_spindle_and_a_point) {
  EXPECT_EQ(refusal("[cmm]\ntooth_marks = true\n", ""),
            "cmm.tooth_marks = true; needs cutting.force = \"instantaneous\"");
  EXPECT_EQ(
      refusal("[cmm]\ntooth_marks = true\nprobe_radius_mm = 1.0\n", "force = \"instantaneous\"\n"),
      "cmm.tooth_marks = true; requires a point stylus: a ball would bridge them (probe_radius_mm "
      "= 0)");
  EXPECT_EQ(refusal("[cmm]\ntooth_marks = true\n", "force = \"instantaneous\"\n"), "");
}

}  // namespace
}  // namespace servomill::sim::evaluation::probed_teeth_test
