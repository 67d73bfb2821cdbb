// The moves of programs under cutter radius compensation.
#include <fmt/format.h>

#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::cutter_radius_motion_test {
namespace {

const std::string kEntry = "G21 F600\nG0 X-20 Y0\nG41.1 D4\nG1 X0 Y0\n";

TEST(CompensatedProgram, LinesAreThoseOfTheBlocks) {
  const std::vector<Move> moves = moves_of(kEntry + "X20\n\n(empty)\nY20\nX40\nG40\nX50 Y30");
  std::vector<int> lines;
  for (const Move& move : moves) lines.push_back(move.line);
  EXPECT_EQ(lines, (std::vector<int>{2, 4, 5, 8, 9, 9, 11}));
  EXPECT_EQ(moves[4].kind, MoveKind::arc);  // around the convex corner
  EXPECT_EQ(moves[4].s_begin, moves[4].s_end);
  EXPECT_EQ(moves[4].feed, moves[5].feed);
}

TEST(CompensatedProgram, WhatIsNoMoveKeepsItsPlace) {
  const std::vector<Move> moves =
      moves_of(kEntry + "X20\nM3 S100\n(MSG, now)\nG4 P1\nM8\nY20\nM5\nM0\nM9");
  std::vector<MoveKind> kinds;
  for (const Move& move : moves) kinds.push_back(move.kind);
  using M = MoveKind;
  EXPECT_EQ(kinds,
            (std::vector<M>{M::rapid, M::feed, M::message, M::feed, M::spindle, M::spindle,
                            M::dwell, M::coolant, M::feed, M::spindle, M::stop, M::coolant}));
  expect_axes(moves[6].end, moves[3].end);  // the dwell is where the line was made to end
}

TEST(CompensatedProgram, MovesBesideThePlaneGoWithTheCorner) {
  const std::vector<Move> moves = moves_of(kEntry + "X20\nZ5\nA10\nZ0\nY20");
  ASSERT_EQ(moves.size(), 7U);
  expect_axes(moves[2].end, axes(18, 2, 0));
  expect_axes(moves[3].end, axes(18, 2, 5));
  expect_axes(moves[4].end, axes(18, 2, 5, 10));
  expect_axes(moves[5].end, axes(18, 2, 0, 10));
  expect_axes(moves[6].end, axes(18, 20, 0, 10));
}

TEST(CompensatedProgram, RotaryAxesTurnAtTheConvexCorner) {
  const std::vector<Move> moves = moves_of(kEntry + "X20\nY-20 A30 Z5");
  ASSERT_EQ(moves.size(), 5U);
  expect_axes(moves[3].end, axes(22, 0, 0, 30));
  expect_axes(moves[4].end, axes(22, -20, 5, 30));
}

TEST(CompensatedProgram, MachineCoordinatesFollow) {
  ProgramSetup setup = usual_setup();
  setup.work_offset[0] = axes(100, 200, 300);
  setup.work_rotation[0] = 90 * deg;
  const std::vector<Move> moves =
      moves_of("G43 H1\n" + kEntry + "X20\nG3 X30 Y10 R10\nG1 X0", setup);
  expect_axes(moves[2].end_machine, axes(98, 220, 0));
  EXPECT_LE((moves[3].centre_machine - axes(90, 220, 0).head<3>()).norm(), 10 * kExact);
}

TEST(CompensatedProgram, PositionIsThatOfTheToolUntilG40) {
  const auto text = [](const std::string& program) { return last_move(program).text; };
  EXPECT_EQ(text(kEntry + "X20\n(DEBUG,#5420 #5421 #<_y>)\nM0\n(DEBUG,#5420 #5421 #<_y>)"),
            "20.000000 2.000000 2.000000");
  EXPECT_EQ(text(kEntry + "X20\nG40\n(DEBUG,#5420 #5421)"), "20.000000 0.000000");
  expect_axes(last_move(kEntry + "X20\nG40\nG91 X1 Y1").end, axes(21, 1, 0));
}

TEST(CompensatedProgram, ABlockWithAnErrorChangesNothing) {
  const std::string good = kEntry + "X20\nM3\n";
  Interpreter interpreter(good + "G54\nY20\nM2\n", "p.nc", usual_setup());
  std::vector<Move> moves;
  int faults = 0;
  for (bool more = true; more;) {
    try {
      const Move* move = interpreter.next();
      more = move != nullptr;
      if (more) moves.push_back(*move);
    } catch (const InputError&) {
      ++faults;
    }
  }
  EXPECT_EQ(faults, 1);
  const std::vector<Move> wanted = moves_of(good + "\nY20");
  ASSERT_EQ(moves.size(), wanted.size() + 1);  // and the end
  for (std::size_t i = 0; i < wanted.size(); ++i) expect_axes(moves[i].end, wanted[i].end);
}

TEST(CompensatedProgram, AnArcInATiltedPlaneKnowsItsPlane) {
  const std::vector<Move> moves =
      moves_of("F600\nG68.2 X0 Y0 Z0 I0 J0 K0\n" + kEntry + "X20\nY-20\nG40\nG69");
  ASSERT_EQ(moves[3].kind, MoveKind::arc);
  EXPECT_NE(moves[3].plane, nullptr);
}

TEST(CompensatedProgram, Warnings) {
  const auto warning = [](const std::string& text) {
    Interpreter interpreter(text + "\nM2\n", "p.nc", usual_setup());
    interpreter.rest();
    std::string all;
    for (const Fault& fault : interpreter.warnings()) {
      all += fmt::format("{}:{}: {}", fault.place.line, fault.place.column, fault.message);
    }
    return all;
  };
  EXPECT_EQ(warning("G41"), "1:1: G41: the tool diameter is 0; the path is not compensated");
  EXPECT_EQ(warning("G42 D1 L3"), "1:8: L has no effect with G42");
  EXPECT_EQ(warning("G41.1 D1 R3"), "1:10: R has no effect with G41.1");
  EXPECT_EQ(warning("G41 D1\nG92.1"),
            "2:1: G92.1 has no effect while cutter compensation is active");
}

TEST(CompensatedProgram, Messages) {
  ProgramSetup setup = usual_setup();
  setup.tools = ToolTable::parse("T1 D8\nT4 D2 Q2\nT5 D2 Q9\n", "tools.tbl");
  const auto expect = [&](const std::string& text, const std::string& message) {
    EXPECT_EQ(fault_of(text, setup), message.empty() ? "" : "p.nc:" + message) << text;
  };
  expect("G19 G41 D1", "1:5: error: G41 is not allowed in the YZ plane; use G17 or G18");
  expect("G41 D1\nG42.1 D1",
         "2:1: error: G42.1 is not allowed with cutter compensation active; program G40 first");
  expect("G41.1", "1:1: error: G41.1 requires a D word (tool diameter)");
  expect("G41 D1.5", "1:5: error: D1.5; must be an integer");
  expect("G41 D-1", "1:5: error: G41 D-1; must be >= 0");
  expect("G41 D7", "1:5: error: D7 is not in the tool table");
  expect("G41.1 D2 L0",
         "1:10: error: L with G41.1 in the XY plane; L, the orientation of a turning tool, "
         "requires G18");
  const std::string turning =
      "error: turning tool of orientation 2; cutter compensation supports round tools only (0 or "
      "9)";
  expect("G18 G41.1 D2 L2", "1:14: " + turning);
  expect("G18 G41.1 D2 L9", "");
  expect("G18 G41 D4", "1:9: " + turning);
  expect("G41 D5", "");
  expect("G43.4 H1\nG41 D1", "2:1: error: G41 is not allowed under TCP control; program G49 first");
  const std::vector<std::string> refused = {
      "G18",   "M6",     "M48",    "M49",          "G43 H1",       "G49",   "G54",
      "G61",   "G64",    "G98",    "G68.2",        "G28",          "G28.1", "G30",
      "G30.1", "G92 X1", "G52 X1", "G10 L2 P1 X1", "G10 L20 P0 X1"};
  for (const std::string& code : refused) {
    const std::string name = code.substr(0, code.find(' '));
    expect("G41 D1\n" + code,
           "2:1: error: " + name +
               " is not allowed with cutter compensation active; program G40 first");
  }
  const std::vector<std::string> taken = {"G17",   "G4 P1",        "G91",    "G90.1", "G93",
                                          "S1 M3", "M8",           "T1",     "M0",    "G80",
                                          "G20",   "G10 L2 P2 X1", "G40 G54"};
  for (const std::string& code : taken) expect("G41 D1\n" + code, "");
  expect("G41 D1\nG0",
         "2:1: error: the first move with cutter compensation is 0.0000 mm long; must be longer "
         "than the tool radius, 4.0000 mm");
  expect(kEntry + "G53 G0 X0",
         "5:1: error: G53 is not allowed with cutter compensation active; program G40 first");
  expect(kEntry + "X20\nG40\nG3 X0 Y20 R30",
         "7:1: error: G3 is the first move after G40; must be G0 or G1");
  expect(kEntry + "X20\nG40\nG1 X20\nG3 X0 Y20 R30", "");
  expect(kEntry + "X20\n#1=[1+#5421]",
         "6: error: #5421 is unknown with cutter compensation active; program G40 first");
  const std::string gouge =
      "the tool cannot reach the line in the concave corner without gouging (move of line 6)";
  expect(kEntry + "X20\nY3\nX0", "7:1: error: " + gouge);
  expect(kEntry + "X20\nY1\nG40", "7:1: error: " + gouge);
  expect(kEntry + "X20\nY1", "7:1: error: " + gouge);  // at M2
}

}  // namespace
}  // namespace servomill::controllers::cutter_radius_motion_test
