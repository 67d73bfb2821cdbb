#include "controllers/gcode/interpreter.h"

#include <cmath>
#include <numbers>
#include <random>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/modal_state.h"
#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::interpreter_test {
namespace {

using std::numbers::pi;

TEST(Motion, StaysModalAndKeepsAxesThatAreNotNamed) {
  const auto moves = moves_of("G0 X1 Y2 Z3 A4 B5 C6\nG1 X10 F600\nY20");
  ASSERT_EQ(moves.size(), 3u);
  EXPECT_EQ(moves[0].kind, MoveKind::rapid);
  EXPECT_EQ(moves[2].kind, MoveKind::feed);
  expect_axes(moves[2].end, axes(10, 20, 3, 4, 5, 6));
  EXPECT_EQ(moves[2].line, 3);
}

TEST(Motion, G91AddsToThePosition) {
  expect_axes(last_move("G0 X1 A10\nG91 X2 A-30\nX2").end, axes(5, 0, 0, -20));
}

TEST(Units, InchesCountForLengthsOnly) {
  expect_axes(last_move("G20 G0 X1 A90").end, axes(25.4, 0, 0, 90));
  expect_axes(last_move("G0 X25.4\nG20 G91 X1").end, axes(50.8, 0, 0));
}

TEST(Feed, IsPathSpeedOfXyzElseOfTheRotaryAxes) {
  EXPECT_NEAR(last_move("G1 X1 A90 F600").feed, 0.010, kExact);
  EXPECT_NEAR(last_move("G1 A90 F600").feed, 10 * deg, kExact);
  EXPECT_NEAR(last_move("F60\nG20\nG1 X1").feed, 0.001, kExact);  // keeps its physical value
  EXPECT_NEAR(last_move("G20\nG1 X1 F60").feed, 25.4e-3, kExact);
}

TEST(Feed, InverseTimeIsRateTimesLength) {
  EXPECT_NEAR(last_move("G93 G1 X3 Y4 A90 F2").feed, 2.0 / 60.0 * 0.005, kExact);
  EXPECT_NEAR(last_move("G93 G1 A90 F2").feed, 2.0 / 60.0 * pi / 2, kExact);
  // helix: quarter circle of radius 3 mm and 4 mm of height
  const double length = std::hypot(3e-3 * pi / 2, 4e-3);
  EXPECT_NEAR(last_move("G93 G3 X-3 Y3 I-3 Z4 F2").feed, 2.0 / 60.0 * length, kExact);
  EXPECT_EQ(last_move("G93 G1 X3 F2").feed_mode, FeedMode::inverse_time);
}

TEST(Feed, InverseTimeIsNeverSlowerThanATenthOfAUnitPerMinute) {
  EXPECT_NEAR(last_move("G93 G1 X1 F0.09").feed, 0.1 * mm_per_min, kExact);
  EXPECT_NEAR(last_move("G93 G1 X1 F0.11").feed, 0.11 * mm_per_min, kExact);
}

TEST(Arc, CentreRelativeOrAbsolute) {
  for (const char* text : {"G0 X1 Y2\nG2 X5 Y2 I2 F100", "G0 X1 Y2\nG90.1 G2 X5 Y2 I3 J2 F100"}) {
    const Move move = last_move(text);
    EXPECT_EQ(move.kind, MoveKind::arc);
    EXPECT_EQ(move.arc.normal_axis, 2);
    EXPECT_EQ(move.arc.turns, -1);
    EXPECT_NEAR((move.arc.centre - Eigen::Vector3d(3e-3, 2e-3, 0)).norm(), 0.0, kExact);
    EXPECT_NEAR(move.s_end - move.s_begin, 2e-3 * pi, kExact);
  }
}

TEST(Arc, EachPlaneHasItsOwnCentreWordsAndSense) {
  const Move zx = last_move("G18 G3 X2 K1 I1 F100");  // from (z 0, x 0) to (z 0, x 2)
  EXPECT_EQ(zx.arc.normal_axis, 1);
  EXPECT_NEAR((zx.arc.centre - Eigen::Vector3d(1e-3, 0, 1e-3)).norm(), 0.0, kExact);
  const Move yz = last_move("G19 G2 Y2 J1 F100");
  EXPECT_EQ(yz.arc.normal_axis, 0);
  EXPECT_NEAR((yz.arc.centre - Eigen::Vector3d(0, 1e-3, 0)).norm(), 0.0, kExact);
}

TEST(Arc, RadiusFormKnowsFourCircles) {
  // chord of 6 mm along X, radius 5 mm: the centre is 4 mm beside its middle
  const auto centre_y = [](const char* text) { return last_move(text).arc.centre.y(); };
  EXPECT_NEAR(centre_y("G2 X6 R5 F100"), -4e-3, kExact);
  EXPECT_NEAR(centre_y("G3 X6 R5 F100"), 4e-3, kExact);
  EXPECT_NEAR(centre_y("G2 X6 R-5 F100"), 4e-3, kExact);
  EXPECT_NEAR(centre_y("G3 X6 R-5 F100"), -4e-3, kExact);
}

TEST(Arc, WithoutAnEndItIsAFullCircleAndPCountsTurns) {
  EXPECT_NEAR(last_move("G2 I5 F100").s_end, 10e-3 * pi, kExact);
  const Move move = last_move("G3 I5 Z3 P4 F100");
  EXPECT_EQ(move.arc.turns, 4);
  EXPECT_NEAR(move.s_end, std::hypot(4 * 10e-3 * pi, 3e-3), kExact);
}

TEST(Arc, RadiusMayDifferAbsolutelyOrRelatively) {
  // LinuxCNC: 2 * 0.01 * sqrt(2) mm, or 0.1 % up to a hundred times that
  EXPECT_EQ(fault_of("G2 X2.028 I1 F100"), "");
  EXPECT_EQ(fault_of("G2 X2.029 I1 F100"),
            "p.nc:1:1: error: G2: radius is 1.0000 mm at the start and 1.0290 mm at the end; they "
            "may differ by 0.0283 mm or 0.1 %");
  EXPECT_EQ(fault_of("G2 X200.099 I100 F100"), "");
  EXPECT_NE(fault_of("G2 X200.11 I100 F100"), "");
  EXPECT_EQ(fault_of("G2 X20002.8 I10000 F100"), "");
  EXPECT_NE(fault_of("G2 X20002.9 I10000 F100"), "");
}

TEST(Offsets, WorkRotationShiftAndToolAdd) {
  ProgramSetup setup = usual_setup();
  setup.work_offset[1] = axes(100, 200, 300, 10);
  setup.work_rotation[1] = pi / 2;
  const Move move = last_move("G55 G43 H3\nG0 X0 Y0 Z0 A0\nG92 X-1\nG0 X1 Y2 Z3 A4", setup);
  // (1 + 1, 2) turned by 90 degrees is (-2, 2); T3 adds (0.5, -0.25, 33)
  expect_axes(move.end, axes(1, 2, 3, 4));
  expect_axes(move.end_machine, axes(100 - 2 + 0.5, 200 + 2 - 0.25, 300 + 3 + 33, 14));
  EXPECT_EQ(move.work_offset, 2);
  EXPECT_EQ(move.tool_offset, 3);
}

TEST(Offsets, ChangingThemDoesNotMoveTheMachine) {
  for (const char* change : {"G55", "G43 H3", "G92 X7 A9", "G52 Y3", "G10 L2 P1 X5 R30",
                             "G10 L20 P1 X1", "G43.1 X1 Z5", "G49", "G20"}) {
    ProgramSetup setup = usual_setup();
    setup.work_offset[1] = axes(1, 2, 3, 4, 5, 6);
    setup.work_rotation[1] = 0.3;
    const auto moves = moves_of(std::string("G0 X10 Y20 Z30 A5\nM0\n") + change + "\nM0", setup);
    ASSERT_EQ(moves.size(), 3u);
    expect_axes(moves[2].end_machine, moves[0].end_machine);
  }
}

// By whatever word: what counts is where the coordinates lie.
TEST(Offsets, MovesTellThatTheyAreShifted) {
  const auto is_shifted = [](const std::string& program) {
    ProgramSetup setup = usual_setup();
    setup.work_offset = {axes(10, 20, 30, 40), axes(10, 20, 30, 40), axes(10, 20, 30)};
    return last_move("G0 X1 Y2 Z3\n" + program + "\nG1 X5 F100", setup).is_shifted;
  };
  for (const char* shift : {"G52 X0.001", "G92 C7", "G10 L2 P1 Y20.001", "G10 L2 P1 R1",
                            "G10 L20 P0 X0", "G56", "G55\nG10 L2 P2 X0"}) {
    EXPECT_TRUE(is_shifted(shift)) << shift;
  }
  for (const char* none :
       {"G54", "G55", "G56\nG54", "G52 X0", "G92 X1 Y2", "G92 X3\nG92.1", "G10 L2 P1 X10 A40",
        "G10 L20 P1 X1 Y2 Z3", "G10 L2 P3 X0", "G43 H3", "G53 G0 X2", "G91", "G20"}) {
    EXPECT_FALSE(is_shifted(none)) << none;
  }
}

TEST(Offsets, G53IsInMachineCoordinates) {
  ProgramSetup setup = usual_setup();
  setup.work_offset[0] = axes(100, 200, 300, 10);
  setup.work_rotation[0] = 0.3;
  expect_axes(last_move("G43 H1\nG53 G0 X1 Y2 Z3 A4", setup).end_machine, axes(1, 2, 3, 4));
}

TEST(Offsets, G10L20MakesThePositionReadAsItSays) {
  ProgramSetup setup;
  setup.work_rotation[0] = 0.3;
  expect_axes(last_move("G0 X5 Y6 Z7\nG10 L20 P1 X1 Y2 Z3\nM0", setup).end, axes(1, 2, 3));
}

TEST(Offsets, StartIsInMachineCoordinates) {
  ProgramSetup setup = usual_setup();
  setup.work_offset[0] = axes(100, 0, 0);
  setup.start = axes(10, 20, 30);
  const Move move = last_move("G91 G0 X1", setup);
  expect_axes(move.end, axes(-89, 20, 30));
  expect_axes(move.end_machine, axes(11, 20, 30));
}

TEST(Machine, SpindleToolAndCoolant) {
  const auto moves = moves_of("T1\nS3000 M3\nM7\nM8\nT3 M6\nM9\nM1");
  ASSERT_EQ(moves.size(), 8u);
  EXPECT_EQ(moves[0].direction, 0);  // S alone does not turn the spindle
  EXPECT_EQ(moves[1].direction, 1);
  EXPECT_NEAR(moves[1].value, 3000 * rpm, 1e-12);  // rad/s
  EXPECT_EQ(moves[2].number, kMist);
  EXPECT_EQ(moves[3].number, kMist | kFlood);
  EXPECT_EQ(moves[4].direction, 0);  // M6 stops it
  EXPECT_EQ(moves[5].kind, MoveKind::tool);
  EXPECT_EQ(moves[5].number, 3);
  EXPECT_EQ(moves[6].number, 0);
  EXPECT_EQ(moves[7].kind, MoveKind::stop);
}

TEST(Machine, DwellAndPathModesReachTheMoves) {
  EXPECT_DOUBLE_EQ(last_move("G4 P1.5").value, 1.5);
  EXPECT_EQ(last_move("G61 G0 X1").path_mode, PathMode::exact_path);
  EXPECT_EQ(last_move("G61.1 G0 X1").path_mode, PathMode::exact_stop);
  const Move move = last_move("G20\nG64 P0.1 G0 X1");
  EXPECT_EQ(move.path_mode, PathMode::continuous);
  EXPECT_NEAR(move.path_tolerance, 2.54e-3, kExact);
}

TEST(Block, RunsInTheOrderOfTheStandard) {
  // dwell before motion, unit and tool length before the end point, F in the unit before
  const auto moves = moves_of("X1 F60 G1 G20 G43 H1 G4 P1 Z0 M3 T1 M6 S1");
  ASSERT_EQ(moves.size(), 6u);
  EXPECT_EQ(moves[0].kind, MoveKind::spindle);
  EXPECT_EQ(moves[1].kind, MoveKind::tool);
  EXPECT_EQ(moves[2].kind, MoveKind::spindle);
  EXPECT_EQ(moves[3].kind, MoveKind::dwell);
  expect_axes(moves[4].end_machine, axes(25.4, 0, 100));
  EXPECT_NEAR(moves[4].feed, 0.001, kExact);
  EXPECT_EQ(moves[5].direction, 0);  // M2 stops the spindle
}

TEST(Block, WithAnErrorChangesNothing) {
  // F, units, tool, parameters and messages of the faulty block must be gone
  Interpreter interpreter(
      "G1 X1 F60\n#1=5 #<n>=1 (MSG,lost) F600 G20 T1 M6 G91 G2 X9 R1\nG1 X2 Y#1\nM2\n", "p.nc",
      usual_setup());
  ASSERT_TRUE(interpreter.next());
  EXPECT_THROW(interpreter.next(), InputError);
  const auto move = interpreter.next();
  ASSERT_TRUE(move);
  expect_axes(move->end, axes(2, 0, 0));
  EXPECT_NEAR(move->feed, 0.001, kExact);
  EXPECT_EQ(move->kind, MoveKind::feed);
}

TEST(Block, G80YieldsToTheMotionOfItsBlock) {
  EXPECT_EQ(last_move("G0 G17 G40 G80 X1\nX2").kind, MoveKind::rapid);
  EXPECT_EQ(last_move("G80 G1 X1 F60").kind, MoveKind::feed);
}

TEST(Program, EndsAtM2OrAtTheSecondPercent) {
  EXPECT_EQ(interpret("G0 X1\nM30\nnonsense (\n", "p.nc", {}).size(), 2u);
  EXPECT_EQ(interpret("\n%\nG0 X1\n%\nnonsense (\n", "p.nc", {}).size(), 1u);
}

TEST(Program, BlockDeleteIsASwitch) {
  ProgramSetup setup;
  EXPECT_EQ(moves_of("/ G0 X1\n/ N5 G0 X2", setup).size(), 2u);
  setup.block_delete = true;
  EXPECT_EQ(moves_of("/ G0 X1\n/ O nonsense", setup).size(), 0u);
}

TEST(Program, ArcLengthRunsThroughLinesAndArcs) {
  const auto moves = moves_of("G0 X3 Y4\nG1 A90 F100\nG4 P1\nG2 I1\nG1 Z-2");
  EXPECT_NEAR(moves[0].s_end, 5e-3, kExact);
  EXPECT_EQ(moves[1].s_end, moves[1].s_begin);  // rotary axes only
  EXPECT_EQ(moves[2].s_begin, moves[1].s_end);
  EXPECT_NEAR(moves[3].s_end, 5e-3 + 2e-3 * pi, kExact);
  EXPECT_NEAR(moves[4].s_end, 7e-3 + 2e-3 * pi, kExact);
}

TEST(CanonJson, ShowsMillimetresAndDegrees) {
  const auto moves = moves_of("G1 X1.5 A-90 F600\nG18 G2 X2 I0.25 F300\n(PRINT,a\"b)\nS100 M4");
  EXPECT_EQ(canon_json(moves[0]),
            R"({"t":"feed","line":1,"end":[1.5,0,0,-90,0,0],"mend":[1.5,0,0,-90,0,0],)"
            R"("feed":600,"fmode":"upm"})");
  EXPECT_EQ(canon_json(moves[1]),
            R"({"t":"arc","line":2,"end":[2,0,0,-90,0,0],"mend":[2,0,0,-90,0,0],"feed":300,)"
            R"("fmode":"upm","plane":"XZ","center":[0,1.75],"mcenter":[1.75,0,0],"turns":-1})");
  EXPECT_EQ(canon_json(moves[2]), R"({"t":"print","line":3,"text":"a\"b"})");
  EXPECT_EQ(canon_json(moves[4]), R"({"t":"spindle","line":4,"dir":-1,"rpm":100})");
}

// Random bytes, and random words that look like a program: an error or success, and an end.
TEST(Fuzz, AnyBytesGiveInputErrorOrSuccess) {
  constexpr int kPrograms = 3000;
  constexpr std::string_view kLikely =
      "GGGXYZABCIJKRFPMTSN0123456789.-+#[]<>=/*()%; \n\nSINMODEQATAN";
  std::mt19937 random(1);
  for (int k = 0; k < kPrograms; ++k) {
    std::string text;
    const std::size_t length = 1 + random() % 300;
    for (std::size_t i = 0; i < length; ++i) {
      text += k % 3 == 0 ? static_cast<char>(random() % 256) : kLikely[random() % kLikely.size()];
    }
    try {
      interpret(text, "fuzz", usual_setup());
    } catch (const InputError& error) {
      EXPECT_FALSE(error.faults().empty()) << text;
    }
    check_program(text, "fuzz", usual_setup());
  }
}

}  // namespace
}  // namespace servomill::controllers::interpreter_test
