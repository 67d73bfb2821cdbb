// The way of the tool in canned cycles. That the moves are LinuxCNC's is tested by conformance
// programs (cycle_*.ngc); here are the closed forms, what a simulation adds, and the messages.
#include "controllers/gcode/canned_cycles.h"

#include <cmath>

#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::canned_cycles_test {
namespace {

using Kind = CycleStep::Kind;

constexpr double kLevelTol = 1e-12;  // units of the program: some sums at magnitudes below 100

// Deepest level of feeding, and how often the tool is drawn back.
TEST(CycleSteps, PecksReachTheBottomInAsManyStepsAsTheyNeed) {
  for (const int code : {730, 830}) {
    for (const double peck : {0.5, 1.0, 2.5, 3.0, 9.0, 20.0}) {
      const CycleHole hole = {.r = 2, .clear = 5, .bottom = -7, .peck = peck, .backed_off = 0.25};
      int feeds = 0;
      double depth = hole.r;
      for (const CycleStep& step : cycle_steps(code, hole)) {
        if (step.kind != Kind::feed) continue;
        EXPECT_LE(depth - step.level, peck + kLevelTol);
        depth = step.level;
        ++feeds;
      }
      EXPECT_EQ(depth, hole.bottom);
      EXPECT_EQ(feeds, std::ceil(9.0 / peck)) << peck;
    }
  }
}

TEST(CycleSteps, PecksComeBackShortlyAboveTheLastDepth) {
  const CycleHole hole = {.r = 2, .clear = 5, .bottom = -1, .peck = 2, .backed_off = 0.25};
  const auto levels_of = [&](int code) {
    std::vector<double> levels;
    for (const CycleStep& step : cycle_steps(code, hole)) levels.push_back(step.level);
    return levels;
  };
  EXPECT_EQ(levels_of(830), (std::vector<double>{0, 2, 0.25, -1, 5}));
  EXPECT_EQ(levels_of(730), (std::vector<double>{0, 0.25, -1, 5}));
}

TEST(CycleSteps, TheSpindleTurnsBehindEveryCycleAsBefore) {
  for (const int code : {740, 840, 860, 870, 880}) {
    const int before = code == 740 ? -1 : 1;
    const auto steps =
        cycle_steps(code, {.r = 1, .clear = 2, .bottom = -1, .middle = 0, .direction = before});
    int direction = before;
    for (const CycleStep& step : steps) {
      if (step.kind == Kind::spindle) direction = step.direction;
    }
    EXPECT_EQ(direction, before) << code;
  }
}

TEST(CycleSteps, AreNeverMoreThanTheirCount) {
  for (const int code : {730, 740, 810, 820, 830, 840, 850, 860, 870, 880, 890}) {
    const CycleHole hole = {.r = 1, .clear = 2, .bottom = -1, .peck = 0.3};
    EXPECT_LE(static_cast<double>(cycle_steps(code, hole).size()), cycle_step_count(code, hole));
  }
}

TEST(CannedCycle, EndsAboveTheHoleAtROrTheOldLevel) {
  const std::string cycle = "F100\nG0 Z10\nG81 X3 Y4 Z-1 R2";
  expect_axes(last_move("G99\n" + cycle).end, axes(3, 4, 2));
  expect_axes(last_move("G98\n" + cycle).end, axes(3, 4, 10));
}

TEST(CannedCycle, IsReadInInchesToo) {
  expect_axes(last_move("G20 F10\nG81 X1 Z-1 R0.5").end, axes(25.4, 0, 12.7));
}

TEST(CannedCycle, CornersAreExactAndThePathModeComesBack) {
  const auto moves = moves_of("F100\nG64 P0.1\nG0 Z3\nG81 X1 Z-1 R1\nG0 X2");
  for (std::size_t i = 1; i + 1 < moves.size(); ++i) {
    EXPECT_EQ(moves[i].path_mode, PathMode::exact_path);
  }
  EXPECT_EQ(moves.back().path_mode, PathMode::continuous);
  EXPECT_NEAR(moves.back().path_tolerance, 0.1e-3, kExact);
}

TEST(CannedCycle, DrillsAlongTheNormalOfATiltedPlane) {
  const std::string drill = "F100\nG68.2 I0 J0 K30\nG0 X0 Y0 Z5\nG81 X10 Y0 Z-1 R1";
  const Move move = last_move(drill);
  expect_axes(move.end, axes(10, 0, 1));
  EXPECT_NEAR(move.end_machine[0], 10e-3 * std::cos(30 * deg), kExact);
  EXPECT_EQ(move.tool_control, ToolControl::work_plane);
}

TEST(CannedCycle, LengthsOfTheWayCount) {
  const auto moves = moves_of("F100\nG0 Z3\nG81 X4 Z-1 R1");
  EXPECT_NEAR(moves.back().s_end, 3e-3 + 4e-3 + 2e-3 + 2e-3 + 2e-3, kExact);
}

TEST(CannedCycle, TappingOutsideOfG17Warns) {
  Interpreter interpreter("F100 S100 M3\nG18\nG84 X1 Y5 Z6 R10 L2\nM2\n", "p.nc", {});
  interpreter.rest();
  ASSERT_EQ(interpreter.warnings().size(), 1u);
  EXPECT_EQ(to_string(interpreter.warnings()[0].place), "p.nc:3:1");
  EXPECT_EQ(interpreter.warnings()[0].message,
            "G84 outside G17 swaps coordinates, as in LinuxCNC 2.9; use G17 for tapping");
}

TEST(CannedCycle, FaultsNameTheWordAndTheRule) {
  const auto fault = [](const std::string& block) { return fault_of("F100\nG0 Z10\n" + block); };
  EXPECT_EQ(fault("G81 X1 Z-1"), "p.nc:3:1: error: G81 requires R, which no earlier G81 has set");
  EXPECT_EQ(fault("G81 X1 R1"), "p.nc:3:1: error: G81 requires Z, which no earlier G81 has set");
  EXPECT_EQ(fault("G19 G81 Y1 R1"),
            "p.nc:3:5: error: G81 requires X, which no earlier G81 has set");
  EXPECT_EQ(fault("G83 X1 Z-1 R1"),
            "p.nc:3:1: error: G83 requires Q, which no earlier G83 has set");
  EXPECT_EQ(fault("G81 X1 Z-1 R1\nG82 Z-1 R1"),
            "p.nc:4:1: error: G82 requires P, which no earlier G82 has set");
  EXPECT_EQ(fault("G87 X1 Z-1 R1 I1 K0"),
            "p.nc:3:1: error: G87 requires J, which no earlier G87 has set");
  EXPECT_EQ(fault("G81 X1 Z-1 R-2"), "p.nc:3:12: error: G81: R = -2 is below Z = -1, the bottom");
  EXPECT_EQ(fault("G83 X1 Z-1 R1 Q0"), "p.nc:3:15: error: Q0; must be > 0");
  EXPECT_EQ(fault("G73 X1 Z-1 R1 Q-2"), "p.nc:3:15: error: Q-2; must be > 0");
  EXPECT_EQ(fault("G82 X1 Z-1 R1 P-2"), "p.nc:3:15: error: P-2; must be >= 0");
  EXPECT_EQ(fault("G81 X1 Z-1 R1 L0"), "p.nc:3:15: error: L0; must be at least 1");
  EXPECT_EQ(fault("G81 X1 Z-1 R1 L1.5"), "p.nc:3:15: error: L1.5; must be an integer");
  EXPECT_EQ(fault("G81 X1 Z-1 R1 C5"),
            "p.nc:3:15: error: C word with G81; rotary axes are not allowed in a cycle");
  EXPECT_EQ(fault("G81 R1"), "p.nc:3:1: error: G81 requires an axis word");
  EXPECT_EQ(fault("G93 G81 X1 Z-1 R1 F1"),
            "p.nc:3:5: error: G81 with G93; a cycle requires G94 or G95");
  EXPECT_EQ(fault("F0\nG81 X1 Z-1 R1"),
            "p.nc:4:1: error: G81 with zero feed rate; F0 is active, F must be > 0");
  EXPECT_EQ(fault("G17.1 G81 X1 Z-1 R1"),
            "p.nc:3:7: error: G81 is not supported in a plane of U, V and W (G17.1 G18.1 G19.1); "
            "use G17, G18 or G19");
  EXPECT_EQ(fault("G84 X1 Z-1 R1"),
            "p.nc:3:1: error: G84 requires a running spindle; start it with M3");
  EXPECT_EQ(fault("G74 X1 Z-1 R1"),
            "p.nc:3:1: error: G74 requires a running spindle; start it with M4");
  EXPECT_EQ(fault("M4 G84 X1 Z-1 R1"),
            "p.nc:3:4: error: G84 with the spindle running counter-clockwise (M4); it requires M3");
  EXPECT_EQ(fault("M3 G74 X1 Z-1 R1"),
            "p.nc:3:4: error: G74 with the spindle running clockwise (M3); it requires M4");
  EXPECT_EQ(fault("G86 X1 Z-1 R1 P1"),
            "p.nc:3:1: error: G86 requires a running spindle; start it with M3 or M4");
}

TEST(CannedCycle, OfEndlessPecksIsRefused) {
  EXPECT_EQ(fault_of("F100\nG83 X1 Z-1 R1 Q0.00001"),
            "p.nc:2:15: error: G83 would generate 600006 moves; must be <= 100000");
  EXPECT_EQ(fault_of("F100\nG81 X1 Z-1 R1 L10000"),
            "p.nc:2:15: error: G81 would generate 150000 moves; must be <= 100000");
  EXPECT_EQ(fault_of("F100\nG73 X1 Z-1000 R1 Q0.000000000000000001").substr(0, 21),
            "p.nc:2:18: error: G73");
}

// P of G81 has no effect there (Fanuc, Haas), but is kept for G82.
TEST(CannedCycle, RefusesANegativeDwellThatItDoesNotMake) {
  ProgramSetup setup;
  setup.reader = Reader::fanuc;
  setup.decimal_point = DecimalPoint::calculator;
  Interpreter interpreter("G0 Z5.\nG99 G81 X1. Z-2. R1. P-500 F100.\nM2\n", "p.nc", setup);
  try {
    while (interpreter.next() != nullptr) continue;
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "p.nc:2:22: error: P-500; must be >= 0");
  }
}

TEST(CannedCycle, WithAFaultChangesNothing) {
  Interpreter interpreter("F100\nG98 G0 Z10\nG81 X1 Z-1 R1\nR0 X3 Z2\nX2\nM2\n", "p.nc", {});
  std::vector<Move> moves;
  int faults = 0;
  for (bool more = true; more;) {
    try {
      const auto move = interpreter.next();
      more = move != nullptr;
      if (more) moves.push_back(*move);
    } catch (const InputError&) {
      ++faults;
    }
  }
  EXPECT_EQ(faults, 1);
  // X2 drills from R1 to Z-1
  ASSERT_EQ(moves.size(), 1u + 4u + 4u + 1u);
  expect_axes(moves[6].end, axes(2, 0, 1));
  expect_axes(moves[7].end, axes(2, 0, -1));
}

}  // namespace
}  // namespace servomill::controllers::canned_cycles_test
