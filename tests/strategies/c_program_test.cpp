/// Programs that plug-ins rewrite.
#include "strategies/c_program.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "plant/kinematics/chain.h"
#include "plant/vocabulary/units.h"

namespace servomill::strategies::c_program_test {
namespace {

const JointLayout& layout() {
  static const JointLayout kLayout =
      plant::make_chain(plant::parse_structure("[w C' B' X b Y Z t]")).layout;
  return kLayout;
}

Move motion(MoveKind kind, const Joints& Q, int line, double s_begin, double s_end) {
  Move move;
  move.kind = kind;
  move.line = line;
  move.end_machine = layout().words(Q);
  move.end = move.end_machine;
  move.end[0] += 0.25;  // the zero of the part lies elsewhere
  move.s_begin = s_begin;
  move.s_end = s_end;
  move.feed = 0.02;
  return move;
}

// A line of 10 mm, a dwell, a half circle of the radius 5 mm, a turn of C alone.
std::vector<Move> program() {
  std::vector<Move> moves;
  moves.push_back(motion(MoveKind::feed, {10 * mm, 0, 0, 0, 0}, 3, 0.0, 10 * mm));
  moves.emplace_back();
  moves.back().kind = MoveKind::dwell;
  moves.push_back(motion(MoveKind::arc, {20 * mm, 0, 0, 0, 0}, 5, 10 * mm,
                         10 * mm + 5 * mm * std::numbers::pi));
  moves.back().arc.centre = {15 * mm + 0.25, 0.0, 0.0};
  moves.back().centre_machine = {15 * mm, 0.0, 0.0};
  moves.back().arc.turns = -1;
  moves.push_back(
      motion(MoveKind::feed, {20 * mm, 0, 0, 0, 0.5}, 6, moves.back().s_end, moves.back().s_end));
  moves.back().feed = 0.1;  // rad/s
  return moves;
}

servomill_block block(std::size_t move, double share, const Joints& end, double factor = 1.0) {
  servomill_block out{};
  out.size = sizeof out;
  out.move = move;
  out.share = share;
  std::copy_n(end.data(), kJoints, out.end);
  out.feed_factor = factor;
  return out;
}

std::vector<Move> rewritten(const std::vector<servomill_block>& blocks, bool rotary = false) {
  std::vector<Move> out;
  EXPECT_EQ(put_with_blocks(program(), blocks, layout(), Joints::Zero(), rotary,
                            [&](const Move& move) { out.push_back(move); }),
            "");
  return out;
}

std::string wrong_with(const std::vector<servomill_block>& blocks, bool rotary = false) {
  return put_with_blocks(program(), blocks, layout(), Joints::Zero(), rotary, [](const Move&) {});
}

TEST(CProgram, ShowsTheMotions) {
  const std::vector<Move> moves = program();
  CProgram shown(moves, layout(), Joints::Zero());
  const servomill_program& seen = *shown.program();
  ASSERT_EQ(seen.move_count, 3U);
  EXPECT_EQ(seen.moves[0]->kind, SERVOMILL_LINE);
  EXPECT_EQ(seen.moves[1]->kind, SERVOMILL_ARC);
  EXPECT_EQ(seen.moves[1]->line, 5);
  EXPECT_EQ(seen.moves[1]->s_begin, 10 * mm);
  EXPECT_EQ(seen.moves[2]->end[4], 0.5);
  EXPECT_EQ(seen.moves[2]->feed, 0.1);
  // clockwise from X10 to X20 about X15: the middle is at Y5
  Joints Q;
  seen.position(seen.host, 1, 0.5, Q.data());
  EXPECT_NEAR(Q[0], 15 * mm, 1e-15);
  EXPECT_NEAR(Q[1], 5 * mm, 1e-15);
  for (const auto& [move, share] : {std::pair{3UL, 0.5}, {1UL, 1.1}, {1UL, -0.1}}) {
    seen.position(seen.host, move, share, Q.data());
    EXPECT_TRUE(std::isnan(Q[0]));
  }
}

TEST(CProgram, LeavesMotionsWithoutBlocks) {
  const std::vector<Move> out = rewritten({}), was = program();
  ASSERT_EQ(out.size(), was.size());
  for (std::size_t n = 0; n < out.size(); ++n) {
    EXPECT_EQ(out[n].kind, was[n].kind);
    EXPECT_EQ(out[n].end_machine, was[n].end_machine);
    EXPECT_EQ(out[n].feed, was[n].feed);
  }
}

TEST(CProgram, PutsBlocksInPlaceOfMotions) {
  const auto out = rewritten({block(0, 0.25, {2.5 * mm, 1 * um, 0, 0, 0}),
                              block(0, 1.0, {10 * mm, 2 * um, 0, 0, 0}, 0.5),
                              block(1, 1.0, {20 * mm, 3 * um, 0, 0, 0})});
  ASSERT_EQ(out.size(), 5U);
  EXPECT_EQ(out[0].line, 3);
  EXPECT_EQ(out[0].s_begin, 0.0);
  EXPECT_EQ(out[0].s_end, 2.5 * mm);
  EXPECT_EQ(out[0].feed, 0.02);
  EXPECT_EQ(out[0].end_machine[1], 1 * um);
  EXPECT_NEAR(out[0].end[0], 0.25 + 2.5 * mm, 1e-15);  // displaced with the zero of the part
  EXPECT_EQ(out[1].s_begin, 2.5 * mm);
  EXPECT_EQ(out[1].s_end, 10 * mm);
  EXPECT_EQ(out[1].feed, 0.01);
  EXPECT_EQ(out[2].kind, MoveKind::dwell);
  EXPECT_EQ(out[3].kind, MoveKind::feed);  // a chord of the arc
  EXPECT_EQ(out[3].s_end, program()[2].s_end);
  EXPECT_EQ(out[4].end_machine, program()[3].end_machine);
}

// X, Y and Z would take the angular feed for their own.
TEST(CProgram, KeepsLinearAxesWhileRotaryAxesTurnAlone) {
  const auto out = rewritten(
      {block(1, 1.0, {20 * mm, 3 * um, 0, 0, 0}), block(2, 1.0, {20 * mm, 9 * um, 0, 0, 0.5})});
  EXPECT_EQ(out[3].end_machine[1], 3 * um);
  EXPECT_EQ(out[3].feed, 0.1);
}

TEST(CProgram, DisplacesRotaryAxesIfDeclared) {
  const auto turned = block(0, 1.0, {10 * mm, 0, 0, 0, 1e-6});
  const auto out = rewritten({turned, block(1, 1.0, {20 * mm, 0, 0, 0, 0})}, true);
  EXPECT_EQ(layout().joints(out[0].end_machine)[4], 1e-6);
  EXPECT_EQ(wrong_with({turned}),
            "block 1 (line 3) displaces the rotary axis C, contrary to its declaration");
}

TEST(CProgram, RefusesBlocksThatAreNone) {
  const Joints at = {10 * mm, 0, 0, 0, 0};
  Joints nan = at, far = at;
  nan[1] = std::numeric_limits<double>::quiet_NaN();
  far[2] = -1e4;
  const std::string first = "block 1 (line 3) ";
  EXPECT_EQ(wrong_with({block(0, 1.0, nan)}), first + "ends at Y = nan, which is not finite");
  EXPECT_EQ(wrong_with({block(0, 1.0, far)}),
            first + "ends at Z = -10000 m, implausible for any machine");
  EXPECT_EQ(wrong_with({block(0, 0.0, at)}), first + "ends at a share of 0, expected > 0 and <= 1");
  EXPECT_EQ(wrong_with({block(0, 1.5, at)}),
            first + "ends at a share of 1.5, expected > 0 and <= 1");
  EXPECT_EQ(wrong_with({block(0, 0.5, at), block(0, 0.5, at)}),
            "block 2 (line 3) ends at a share of 0.5, expected > 0.5 and <= 1");
  EXPECT_EQ(wrong_with({block(0, 0.5, at)}),
            "the blocks of motion 0 (line 3) end at a share of 0.5, expected 1");
  for (const double factor : {0.0, -1.0, 1e4, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(wrong_with({block(0, 1.0, at, factor)}).starts_with(first + "has the feed factor"));
  }
  EXPECT_EQ(wrong_with({block(3, 1.0, at)}),
            "block 1 refers to motion 3 after motion 0, or to a missing motion");
  EXPECT_EQ(wrong_with({block(1, 1.0, {20 * mm, 0, 0, 0, 0}), block(0, 1.0, at)}),
            "block 2 refers to motion 0 after motion 1, or to a missing motion");
  EXPECT_EQ(wrong_with({block(0, 1.0, {10 * mm, 1 * um, 0, 0, 0})}),
            "the arc of line 5 has no blocks, and the blocks before it end elsewhere");
}

TEST(PluginStructs, TellWhichMembersTheyHave) {
  servomill_reading reading{};
  reading.size = offsetof(servomill_reading, Q_cmd);  // of a program that was built before
  EXPECT_TRUE(SERVOMILL_HAS(&reading, sensor_count));
  EXPECT_FALSE(SERVOMILL_HAS(&reading, Q_cmd));
  reading.size = sizeof reading;
  EXPECT_TRUE(SERVOMILL_HAS(&reading, Q_cmd));
}

TEST(CProgram, TakesNoMoreBlocksThanMemoryHolds) {
  const std::vector<Move> moves = program();
  CProgram shown(moves, layout(), Joints::Zero());
  const servomill_program& seen = *shown.program();
  const servomill_block one = block(0, 1.0, Joints::Zero());
  for (std::size_t n = 0; n < kMaxPluginBlocks + 100; ++n) seen.add_block(seen.host, &one);
  const auto blocks = shown.take_blocks();
  EXPECT_EQ(blocks.size(), kMaxPluginBlocks + 1);
  EXPECT_EQ(wrong_with(blocks), "adds more than 5000000 blocks");
}

}  // namespace
}  // namespace servomill::strategies::c_program_test
