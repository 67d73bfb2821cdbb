// Feeds of corrected blocks on which rotary axes turn.
#include "tests/sim/programs/compensate/trial.h"

namespace servomill::sim::programs::timed_feed_test {
namespace {

// X is 10 um off at C90, Y and C are where they should be.
const std::string kTable =
    "[errors.table]\nEXC = { harmonic = { amplitude_um = 10.0, period_deg = 360.0 } }\n";
const std::string kStart = "G21 G90 G54\nT1 M6\nG43 H1\nS1000 M3\nG0 X0 Y0 Z50 A0 C0\n";

Trial on_a_trunnion(const std::string& program) {
  Trial trial(program, "table.ngc");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/generic_trunnion_ac.toml";
  trial.request.error_file = written("table.toml", kTable);
  trial.request.work_offsets = {"X=0,Y=0,Z=-90,A=0,C=0"};
  trial.request.inputs.parameter_file.clear();
  trial.request.program_name = "TABLE";
  trial.request.program_number = 7;
  trial.request.retract_Z = 0.2;
  return trial;
}

// s, of the feeds of a program, as LinuxCNC runs it
double time_of(const std::string& text, const Trial& trial) {
  double time = 0.0;
  AxisWords at = AxisWords::Zero();
  for (const Move& move : moves_of(text, trial.request)) {
    if (!is_motion(move.kind)) continue;
    const AxisWords moved = move.end_machine - at;
    at = move.end_machine;
    const double length = moved.head<3>().norm();
    const double way = length > 0.0 ? length : moved.tail<3>().norm();
    if (move.kind == MoveKind::feed && way > 0.0) time += way / move.feed;
  }
  return time;
}

// A quarter turn at 90 deg/min takes 60 s, also with a correction of 10 um in X. Under G93 LinuxCNC
// feeds X at 0.1 mm/min at least: its 10 um, and with them the table, would take 6 s.
TEST(TimedFeed, TurnsATableAsSlowlyAsProgrammed) {
  for (const std::string block : {"G1 C90 F90\n", "G93 G1 C90 F1\nG94\n"}) {
    const Trial trial = on_a_trunnion(kStart + block + "G0 Z60\nM2\n");
    const std::string text = trial.run().program;
    EXPECT_NEAR(time_of(text, trial), 60.0, 0.1) << text;
  }
}

TEST(TimedFeed, RestoresTheFeedOfTheProgram) {
  const Trial trial = on_a_trunnion(kStart + "G1 C90 F90\nX10 F300\nM2\n");
  const std::string text = trial.run().program;
  EXPECT_NE(text.find("F90\n"), std::string::npos) << text;
  EXPECT_NEAR(time_of(text, trial), 62.0, 0.1) << text;
}

// The corrections of a table lengthen or shorten the way of X, Y and Z, which F counts.
TEST(TimedFeed, KeepsTheTimeBesideMovesOfOtherAxes) {
  const Trial trial = on_a_trunnion(kStart + "G1 X0.5 C180 F10\nM2\n");
  EXPECT_NEAR(time_of(trial.run().program, trial), 3.0, 0.003);
}

// Rotary axes that carry the correction of a straight move: linear and rotary axes together have no
// common feed but under G93.
TEST(TimedFeed, GivesStraightMovesTheirTimeWhereRotaryAxesCorrectThem) {
  for (const Dialect dialect : {Dialect::fanuc, Dialect::siemens, Dialect::heidenhain}) {
    Trial trial = on_a_trunnion(kStart + "G1 Z20 F500\nX60 Y40\nG0 Z60\nM2\n");
    trial.request.error_file = written(
        "tilt.toml",
        "[errors.tilt]\nEAX = { harmonic = { amplitude_urad = 200.0, period_mm = 90.0 } }\n");
    trial.request.axes = strategies::DisplacedAxes::all;
    trial.request.dialect = dialect;
    const std::string text = trial.run().program;
    EXPECT_NE(text.find(dialect == Dialect::heidenhain ? "FT" : "G93"), std::string::npos) << text;
  }
}

// A rapid from an unknown place was divided from an assumed zero: G0 A0 C0 came first.
TEST(SplitRapids, BeginWhereThePositionIsKnown) {
  Trial trial = on_a_trunnion(
      "G21 G90 G54\nT1 M6\nS1000 M3\nG0 X10 Y10\nG43 H1 Z50\nG0 A20 C30\nG0 "
      "X60 Y50\nM2\n");
  trial.request.corrects_rapids = true;
  trial.request.error_file = written(
      "wave.toml", "[errors.w]\nEYX = { harmonic = { amplitude_um = 40.0, period_mm = 30.0 } }\n");
  const std::string text = trial.run().program;
  EXPECT_EQ(text.find("G0 A0"), std::string::npos) << text;
  const auto blocks = std::count(text.begin(), text.end(), '\n');
  EXPECT_GT(blocks, 14) << text;
}

}  // namespace
}  // namespace servomill::sim::programs::timed_feed_test
