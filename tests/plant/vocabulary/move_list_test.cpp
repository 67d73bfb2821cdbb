/// A list of moves returns the moves that were put in.
#include "plant/vocabulary/move_list.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <random>

#include "tests/counting_new.h"

namespace servomill::move_list_test {
namespace {

// Every member differs from move to move now and then, signs of zero included.
std::vector<Move> random_moves(std::size_t count) {
  std::mt19937 dice(11);
  const auto below = [&](unsigned n) { return static_cast<int>(dice() % n); };
  const auto number = [&]() -> double {
    constexpr double kOdd[] = {0.0, -0.0, std::numeric_limits<double>::infinity(), 5e-324};
    const int n = below(8);
    return n < 4 ? kOdd[n] : static_cast<double>(below(1000)) / 7.0;
  };
  const auto plane = std::make_shared<const WorkPlane>();
  Move move;
  std::vector<Move> out;
  for (std::size_t n = 0; n < count; ++n) {
    if (below(4) == 0) move.kind = static_cast<MoveKind>(below(10));
    if (below(4) != 0) ++move.line;
    if (below(2) == 0) move.end[below(6)] = number();
    if (below(2) == 0) move.end_machine[below(6)] = number();
    if (below(5) == 0) move.arc = {below(3), {number(), number(), number()}, below(5) - 2};
    if (below(5) == 0) move.centre_machine[below(3)] = number();
    if (below(9) == 0) move.feed = number();
    if (below(9) == 0) move.feed_mode = static_cast<FeedMode>(below(3));
    if (below(9) == 0) move.path_mode = static_cast<PathMode>(below(3));
    if (below(9) == 0) move.path_tolerance = number();
    if (below(9) == 0) move.value = number();
    if (below(9) == 0) move.number = below(200) - 100;
    if (below(9) == 0) move.tool_control = static_cast<ToolControl>(below(4));
    if (below(9) == 0) move.direction = below(3) - 1;
    if (below(9) == 0) move.work_offset = 1 + below(9);
    if (below(9) == 0) move.is_shifted = below(2) == 0;
    if (below(9) == 0) move.tool_offset = below(100000) - 1;
    if (below(9) == 0) move.tool_axis[below(3)] = number();
    if (below(9) == 0) move.plane = below(2) == 0 ? nullptr : std::make_shared<WorkPlane>();
    if (below(20) == 0) move.plane = plane;
    if (below(9) == 0) move.text = below(2) == 0 ? "" : std::string(30, 'a') + std::to_string(n);
    move.s_begin = below(3) == 0 ? number() : move.s_end;
    move.s_end = number();
    out.push_back(move);
  }
  return out;
}

template <class Vector>
bool same_bits(const Vector& a, const Vector& b) {
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return false;
  }
  return true;
}
bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void expect_same(const Move& a, const Move& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.line, b.line);
  EXPECT_TRUE(same_bits(a.end, b.end));
  EXPECT_TRUE(same_bits(a.end_machine, b.end_machine));
  EXPECT_EQ(a.arc.normal_axis, b.arc.normal_axis);
  EXPECT_TRUE(same_bits(a.arc.centre, b.arc.centre));
  EXPECT_EQ(a.arc.turns, b.arc.turns);
  EXPECT_TRUE(same_bits(a.centre_machine, b.centre_machine));
  EXPECT_TRUE(same_bits(a.feed, b.feed));
  EXPECT_EQ(a.feed_mode, b.feed_mode);
  EXPECT_EQ(a.path_mode, b.path_mode);
  EXPECT_TRUE(same_bits(a.path_tolerance, b.path_tolerance));
  EXPECT_TRUE(same_bits(a.value, b.value));
  EXPECT_EQ(a.number, b.number);
  EXPECT_EQ(a.tool_control, b.tool_control);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.work_offset, b.work_offset);
  EXPECT_EQ(a.is_shifted, b.is_shifted);
  EXPECT_EQ(a.tool_offset, b.tool_offset);
  EXPECT_TRUE(same_bits(a.tool_axis, b.tool_axis));
  EXPECT_EQ(a.plane, b.plane);
  EXPECT_EQ(a.text, b.text);
  EXPECT_TRUE(same_bits(a.s_begin, b.s_begin));
  EXPECT_TRUE(same_bits(a.s_end, b.s_end));
}

TEST(MoveList, GivesBackEveryMemberOfEveryMove) {
  for (const std::size_t count : {0U, 1U, 255U, 256U, 257U, 2000U}) {
    const std::vector<Move> moves = random_moves(count);
    const MoveList list(moves);
    ASSERT_EQ(list.size(), count);
    std::size_t n = 0;
    for (const Move& move : list) {
      SCOPED_TRACE(n);
      expect_same(move, moves[n++]);
    }
    EXPECT_EQ(n, count);
  }
}

TEST(MoveList, GivesBackAnyMoveAlone) {
  const std::vector<Move> moves = random_moves(1000);
  const MoveList list(moves);
  for (const std::size_t n : {0U, 1U, 255U, 256U, 511U, 513U, 999U}) expect_same(list[n], moves[n]);
}

TEST(MoveList, GoesOnBehindACopy) {
  const std::vector<Move> moves = random_moves(600);
  MoveList list{std::span<const Move>(moves).first(300)};
  const MoveList copy = list;
  for (std::size_t n = 300; n < 600; ++n) list.push_back(moves[n]);
  EXPECT_EQ(copy.size(), 300U);
  expect_same(list[599], moves[599]);
  expect_same(copy[299], moves[299]);
}

TEST(MoveRange, GoesThroughMovesHeldEitherWay) {
  const std::vector<Move> moves = random_moves(400);
  const MoveList list(moves);
  for (const MoveRange& range : {MoveRange(moves), MoveRange(list)}) {
    EXPECT_EQ(range.size(), moves.size());
    std::size_t n = 0;
    for (const Move& move : range) expect_same(move, moves[n++]);
    EXPECT_EQ(n, moves.size());
  }
}

// 320 bytes as a Move.
TEST(MoveList, TakesSixtyBytesForALineOfThreeAxes) {
  constexpr std::size_t kLines = 100'000;
  std::mt19937 dice(3);
  const std::size_t before = bytes_in_use;
  MoveList list;
  Move move;
  for (std::size_t n = 0; n < kLines; ++n) {
    ++move.line;
    for (int i = 0; i < 3; ++i) move.end[i] = move.end_machine[i] = static_cast<double>(dice());
    move.s_begin = move.s_end;
    move.s_end += 1.0;
    list.push_back(move);
  }
  EXPECT_LE(static_cast<double>(bytes_in_use - before) / kLines, 66.0);
}

// Some 70 MB of moves.
TEST(MoveList, IsOnTheDiskBeyondSomeMegabytes) {
  constexpr std::size_t kLines = 1'200'000;
  const auto set = [](Move& move, std::size_t n) {
    move.line = static_cast<int>(n) + 1;
    for (int i = 0; i < 3; ++i)
      move.end[i] = move.end_machine[i] = 0.1 * static_cast<double>(n) + i;
    move.s_begin = move.s_end;
    move.s_end += 1.0;
  };
  const std::size_t before = bytes_in_use;
  MoveList list;
  Move move;
  for (std::size_t n = 0; n < kLines; ++n) {
    set(move, n);
    list.push_back(move);
  }
  EXPECT_LE(bytes_in_use - before, MoveList::kMaxInMemory + 8 * kLines);
  const MoveList copy = list;
  Move expected;
  std::size_t n = 0, wrong = 0;
  for (const Move& read : copy) {
    set(expected, n++);
    const bool is_same = read.line == expected.line && read.end == expected.end &&
                         read.end_machine == expected.end_machine && read.s_end == expected.s_end;
    wrong += is_same ? 0 : 1;
  }
  EXPECT_EQ(n, kLines);
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(list[kLines - 300].line, static_cast<int>(kLines) - 299);
}

}  // namespace
}  // namespace servomill::move_list_test
