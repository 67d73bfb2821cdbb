// G33 and G33.1: the moves, and what is refused. Programs of tests/conformance are compared with
// LinuxCNC's interpreter.
#include <numbers>

#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::synchronised_test {
namespace {

std::vector<Move> motions_of(const std::string& text) {
  std::vector<Move> moves = moves_of(text);
  std::erase_if(moves, [](const Move& move) { return !is_motion(move.kind); });
  return moves;
}

TEST(Synchronised, RigidTappingGoesToItsDepthAndBackAtTheFeedOfTheLead) {
  const std::vector<Move> moves = motions_of("G21 S1200 M3\nG0 X3 Z5\nG33.1 Z-10 K1.25\nG0 X4");
  ASSERT_EQ(moves.size(), 4U);
  const Move &in = moves[1], &out = moves[2];
  expect_axes(in.end, axes(3, 0, -10));
  expect_axes(out.end, axes(3, 0, 5));
  EXPECT_EQ(in.synchronised, Synchronised::tap_in);
  EXPECT_EQ(out.synchronised, Synchronised::tap_out);
  for (const Move& one : {in, out}) {
    EXPECT_EQ(one.kind, MoveKind::feed);
    EXPECT_EQ(one.path_mode, PathMode::exact_stop);
    EXPECT_EQ(one.feed_mode, FeedMode::units_per_minute);
    EXPECT_NEAR(one.feed, 1200 * 1.25 * mm_per_min, kExact);
    EXPECT_NEAR(one.value, 1.25 * mm, kExact);
    EXPECT_NEAR(one.s_end - one.s_begin, 15 * mm, kExact);
  }
  EXPECT_EQ(in.s_end, out.s_begin);
  EXPECT_EQ(moves[3].synchronised, Synchronised::no);
  expect_axes(moves[3].end, axes(4, 0, 5));
}

TEST(Synchronised, ThreadingIsModalAndTakesItsLeadFromEveryBlock) {
  const std::vector<Move> moves = motions_of("G21 S600 M4\nG33 Z-5 K2\nX7 Z-6 K-1\nG20\nZ-1 K0.1");
  ASSERT_EQ(moves.size(), 3U);
  EXPECT_NEAR(moves[0].feed, 1200 * mm_per_min, kExact);
  EXPECT_NEAR(moves[1].feed, 600 * mm_per_min, kExact);  // the sign of K is that of the spindle
  EXPECT_NEAR(moves[1].value, -1 * mm, kExact);
  EXPECT_NEAR(moves[2].value, 2.54 * mm, kExact);
  for (const Move& one : moves) EXPECT_EQ(one.synchronised, Synchronised::thread);
}

TEST(Synchronised, LeavesTheModalFeedAlone) {
  const std::vector<Move> moves = motions_of("G21 F300 S1000 M3\nG33.1 Z-3 K1\nG1 X5");
  EXPECT_NEAR(moves.back().feed, 300 * mm_per_min, kExact);
  EXPECT_EQ(moves.back().path_mode, PathMode::continuous);
}

TEST(Synchronised, RefusesWithAReason) {
  const auto fault = [](const std::string& block, const std::string& before = "S100 M3\n") {
    const std::string text = fault_of("G21 G43 H1\n" + before + block);
    return text.substr(std::min(text.size(), text.find(": error: ") + 9));
  };
  EXPECT_EQ(fault("G33.1 Z-1 K1"), "");
  EXPECT_EQ(fault("G33.1"), "G33.1 requires an axis word");
  EXPECT_EQ(fault("G33 Z-1"), "G33 requires K, the lead per revolution (F on Fanuc and Haas)");
  EXPECT_EQ(fault("G33 Z-1 K0"), "G33 with K0; the lead must not be zero");
  EXPECT_EQ(fault("G33.1 Z-1 K1 F100"),
            "G33.1 does not accept F; the feed rate is K times the spindle speed");
  EXPECT_EQ(fault("G33.1 Z-1 K1", "S100\n"),
            "G33.1 requires a running spindle; program M3 or M4 first");
  EXPECT_EQ(fault("G33.1 Z-1 K1", "S0 M3\n"), "G33.1 with zero spindle speed; no S is active");
  EXPECT_EQ(fault("G33 Z-1 K1", "G93 S100 M3\n"), "G33 is not allowed with G93; program G94 first");
  EXPECT_EQ(fault("G33 X9 K1", "S100 M3\nG41.1 D4\n"),
            "G33 is not allowed with cutter compensation active; program G40 first");
  EXPECT_EQ(fault("G33.1 Z-1 K1", "S100 M3\nG68.2 X0 Y0 Z0 I10 J20 K0\n"),
            "G33.1 is not allowed under TCP control; cancel G43.4, G43.5 or G68.2 first");
  EXPECT_EQ(fault("G33.1 Z-1 A3 K1"),
            "G33.1 moves X, Y and Z only (LinuxCNC ignores rotary axis words)");
  EXPECT_EQ(fault("G33.1 X0 K1"), "G33.1 requires travel in X, Y or Z");
}

}  // namespace
}  // namespace servomill::controllers::synchronised_test
