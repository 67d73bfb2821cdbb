/// The strategy gcode on programs under tool-centre-point control: blocks of the axes that put tip
/// and tool axis right.
#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison.h"
#include "sim/model/scenario.h"
#include "tests/sim/five_axis_program.h"

namespace servomill::sim::run::tip_rewrite_test {
namespace {

const std::string kFine =
    "axes = \"all\"\niterations = \"converged\"\ntolerance_um = 0.02\ntolerance_urad = 0.05\n";
const std::string kPlain = "[[case]]\nname = \"none\"\nservo = \"ideal\"\n";

// Chords of 0.02 um and 0.05 urad for each joint, levers from the rotary axes to the tip of some
// 0.1 m, corners within 0.05 um.
constexpr double kTip = 0.1;   // um
constexpr double kAxis = 1.0;  // urad

std::string gcode(const std::string& more = kFine) {
  return kPlain + corrected_case("gcode", "ideal", "gcode", more);
}

void expect_corrected(const model::Scenario& scenario, const std::string& section) {
  const Deviation without = deviation_in(run_named_case(scenario, "none"), section);
  EXPECT_GT(without.tip, 10.0);
  EXPECT_GT(without.axis, 10.0);
  const Deviation left = deviation_in(run_named_case(scenario, "gcode"), section);
  EXPECT_LT(left.tip, kTip);
  EXPECT_LT(left.axis, kAxis);
}

TEST(RewrittenTipMoves, PutTipAndToolAxisRightOnGreatCircles) {
  const model::Scenario scenario = trunnion_scenario(
      "G21 G90 G94 G64 P0.00005\nT1 M6\nG43.5 H1\nG0 X-20 Y5 Z20 I0.2 J-0.2 K1\n(MSG, line)\n"
      "G1 X0 Y10 Z25 I0.25 J0 K1 F1500\nX10 Y20 I0.2 J0.3 K1\n(MSG, end)\nM30\n",
      gcode());
  expect_corrected(scenario, "line");
}

TEST(RewrittenTipMoves, FollowRotaryWordsAndArcs) {
  const model::Scenario scenario = trunnion_scenario(
      "G21 G90 G94 G64 P0.00005\nT1 M6\nG43.4 H1\nG0 X-20 Y5 Z20 A15 C10\n(MSG, line)\n"
      "G1 X0 Y10 A20 C30 F1500\n(MSG, arc)\nG3 X10 Y20 I0 J10 A18 C40\n(MSG, end)\nM30\n",
      gcode());
  expect_corrected(scenario, "line");
  expect_corrected(scenario, "arc");
}

// The tip stands: a line on which only the tool axis turns has rows, and takes its time.
TEST(RewrittenTipMoves, TurnTheToolAxisWhereTheTipStands) {
  const model::Scenario scenario = trunnion_scenario(
      "G21 G90 G94 G64 P0.00005\nT1 M6\nG43.5 H1\nG0 X-20 Y5 Z20 I0.2 J-0.2 K1\n(MSG, turn)\n"
      "G1 I0.3 J0.1 K1 F600\n(MSG, end)\nG1 X0\nM30\n",
      gcode());
  expect_corrected(scenario, "turn");
  // the same feed of the rotation, beside its corners
  const double before = run_named_case(scenario, "none").duration;
  EXPECT_NEAR(run_named_case(scenario, "gcode").duration, before, 0.05 * before);
}

TEST(RewrittenTipMoves, LeaveTheToolAxisToLinearAxesAlone) {
  const model::Scenario scenario = trunnion_scenario(
      "G21 G90 G94 G64 P0.00005\nT1 M6\nG43.5 H1\nG0 X-20 Y5 Z20 I0.2 J-0.2 K1\n(MSG, line)\n"
      "G1 X0 Y10 Z25 I0.25 J0 K1 F1500\n(MSG, end)\nM30\n",
      gcode("iterations = \"converged\"\ntolerance_um = 0.02\ntolerance_urad = 0.05\n"));
  const Deviation left = deviation_in(run_named_case(scenario, "gcode"), "line");
  EXPECT_LT(left.tip, kTip);
  EXPECT_GT(left.axis, 10.0);
}

TEST(RewrittenTipMoves, KeepTheFeedOfTheTip) {
  const model::Scenario scenario = trunnion_scenario(
      "G21 G90 G94 G64 P0.00005\nT1 M6\nG43.5 H1\nG0 X-20 Y5 Z20 I0.2 J-0.2 K1\n(MSG, line)\n"
      "G1 X0 Y10 Z25 I0.25 J0 K1 F300\n(MSG, end)\nM30\n",
      gcode());
  const CaseOutput out = run_named_case(scenario, "gcode");
  const records::Series& series = out.result.servo;
  const std::size_t s = *series.column("s"), time = *series.column("time");
  const std::size_t middle = series.rows() / 2;
  const double feed = (series.at(middle + 20, s) - series.at(middle - 20, s)) /
                      (series.at(middle + 20, time) - series.at(middle - 20, time));  // mm/s
  EXPECT_NEAR(feed, 5.0, 0.05);
}

std::string fault_of(const std::string& program) {
  try {
    check_scenario(trunnion_scenario(program, gcode()));
    return "";
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
}

TEST(RewrittenTipMoves, AreRefusedInTiltedPlanesAndWithASecondTool) {
  EXPECT_EQ(fault_of("T1 M6\nG43 H1\nG68.2 X0 Y0 Z0 I0 J20 K0\nG53.1\nG1 X10 F500\nM30\n"),
            "case gcode: moves in a tilted work plane cannot be rewritten");
  EXPECT_EQ(
      fault_of("T1 M6\nG43.4 H1\nG1 X10 Z10 A10 F500\nG49\nT2 M6\nG43.4 H2\nG1 X20 Z10\nM30\n"),
      "case gcode: strategy gcode: rewrites moves under TCP control only for the first tool of the "
      "program; a different one is used here (small.ngc:7)");
}

}  // namespace
}  // namespace servomill::sim::run::tip_rewrite_test
