// G95: a feed that follows the spindle.
#include <numbers>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/printer.h"
#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::feed_per_revolution_test {
namespace {

// The last before M2 stops the spindle.
Move last_fed_move(const std::string& text) {
  const std::vector<Move> moves = moves_of(text);
  return moves.at(moves.size() - 2);
}

TEST(FeedPerRevolution, IsSpeedTimesTheRateOfTheSpindle) {
  const Move move = last_fed_move("S1200 M3\nG95 G1 X10 F0.5");
  EXPECT_EQ(move.feed_mode, FeedMode::units_per_revolution);
  EXPECT_NEAR(move.value, 0.5e-3, kExact);
  EXPECT_NEAR(move.feed, 0.5e-3 * 20, kExact);
  EXPECT_NEAR(last_fed_move("S1200 M4\nG95 G1 A10 F0.5").feed, 0.5 * deg * 20, kExact);
  EXPECT_NEAR(last_fed_move("S1200 M3\nG20 G95\nG1 X1 F0.01").feed, 0.254e-3 * 20, kExact);
}

TEST(FeedPerRevolution, FollowsTheSpeedFromMoveToMove) {
  const auto moves = moves_of("S600 M3\nG95 G1 X10 F0.5\nS1200\nX20\nM5\nX30");
  EXPECT_NEAR(moves[2].feed, 5e-3, kExact);
  EXPECT_NEAR(moves[4].feed, 10e-3, kExact);
  EXPECT_EQ(moves[6].feed, 0.0);
  EXPECT_NEAR(moves[6].value, 0.5e-3, kExact);
}

// Moves wait there for the corner at their end.
TEST(FeedPerRevolution, HoldsUnderCutterCompensation) {
  const auto moves = moves_of("S600 M3\nG95 F0.5\nG41.1 D2 G1 X10\nX20 Y10\nX30\nG40 X40");
  for (const Move& move : moves) {
    if (!is_motion(move.kind)) continue;
    EXPECT_NEAR(move.value, 0.5e-3, kExact) << move.line;
    EXPECT_NEAR(move.feed, 5e-3, kExact) << move.line;
  }
}

TEST(FeedPerRevolution, NeedsASpeed) {
  EXPECT_EQ(fault_of("G95 F1\nG1 X1"),
            "p.nc:2:1: error: G1 under G95 with zero spindle speed; no S is active");
  EXPECT_EQ(fault_of("G95 S100\nG1 X1"), "p.nc:2:1: error: G1 with zero feed rate; no F is active");
}

TEST(FeedPerRevolution, DropsTheFeedOfTheModeBefore) {
  EXPECT_EQ(fault_of("G1 X1 F100\nS100\nG95 X2"),
            "p.nc:3:5: error: G1 with zero feed rate; no F is active");
}

TEST(FeedPerRevolution, IsPrintedAndReadAgain) {
  const std::string text = "S600 M3\nG95 G1 X10 F0.5\nA5\nG94 X20 F600\nM2\n";
  const std::vector<Move> moves = interpret(text, "p.nc", {});
  const PrintedProgram printed = print_program(moves, {.axes = "XA"}, "");
  EXPECT_NE(printed.text.find("G95\nG1 X10 A0 F0.5\nG1 A5\nG94\nG1 X20 F600\n"), std::string::npos)
      << printed.text;
  const std::vector<Move> again = interpret(printed.text, "p.nc", {});
  ASSERT_EQ(again.size(), moves.size());
  for (std::size_t i = 0; i < moves.size(); ++i) {
    EXPECT_NEAR(again[i].feed, moves[i].feed, kExact);
    EXPECT_NEAR(again[i].value, moves[i].value, 1e-12 * moves[i].value);
  }
}

}  // namespace
}  // namespace servomill::controllers::feed_per_revolution_test
