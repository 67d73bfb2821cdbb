#include "sim/engine/program_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "plant/vocabulary/units.h"
#include "tests/mapped_memory.h"

namespace servomill::sim::engine::program_path_test {
namespace {

constexpr double kRounding = 1e-17;  // m, of coordinates of some 10 mm

AxisWords at(double x_mm, double y_mm, double c_deg = 0.0) {
  AxisWords words = AxisWords::Zero();
  words[0] = x_mm * mm;
  words[1] = y_mm * mm;
  words[5] = c_deg * deg;
  return words;
}

Move move_to(const AxisWords& end, int line, double s_begin_mm, double s_end_mm) {
  Move move;
  move.line = line;
  move.end = move.end_machine = end;
  move.s_begin = s_begin_mm * mm;
  move.s_end = s_end_mm * mm;
  return move;
}

Move message(const std::string& text) {
  Move move;
  move.kind = MoveKind::message;
  move.text = text;
  return move;
}

constexpr double kQuarter = 5.0 * std::numbers::pi;  // mm, a quarter of a circle of R 10

// A rapid along X, a line along Y, a turn of C, a quarter circle back along -X and +Y.
std::vector<Move> some_moves() {
  std::vector<Move> moves = {move_to(at(10, 0), 1, 0, 10),
                             message("one"),
                             move_to(at(10, 20), 3, 10, 30),
                             message("two"),
                             move_to(at(10, 20, 90), 5, 30, 30),
                             message("one"),
                             move_to(at(0, 30, 90), 7, 30, 30 + kQuarter)};
  moves[0].kind = MoveKind::rapid;
  moves[6].kind = MoveKind::arc;
  moves[6].centre_machine = moves[6].arc.centre = Eigen::Vector3d(0.0, 20.0 * mm, 0.0);
  moves[6].tool_offset = 4;
  return moves;
}
ProgramPath some_path() { return ProgramPath(some_moves(), at(0, 0)); }

void expect_at(const AxisWords& is, const AxisWords& wanted) {
  EXPECT_LT((is - wanted).cwiseAbs().maxCoeff(), kRounding) << is.transpose();
}

TEST(ProgramPath, IsMadeOfTheMotionOfTheProgram) {
  const ProgramPath path = some_path();
  ASSERT_EQ(path.size(), 4U);
  EXPECT_NEAR(path.length(), (30 + kQuarter) * mm, kRounding);
  EXPECT_EQ(path.piece(0).line, 1);
  EXPECT_TRUE(path.piece(0).rapid);
  EXPECT_FALSE(path.piece(1).rapid);
  EXPECT_EQ(path.piece(3).tool_offset, 4);
}

// A section is a name: the program may return to it.
TEST(ProgramPath, NamesTheSectionsOfTheProgram) {
  const ProgramPath path = some_path();
  EXPECT_EQ(path.sections(), (std::vector<std::string>{"", "one", "two"}));
  EXPECT_EQ(path.piece(0).section, 0);
  EXPECT_EQ(path.piece(1).section, 1);
  EXPECT_EQ(path.piece(2).section, 2);
  EXPECT_EQ(path.piece(3).section, 1);
}

using Pieces = ProgramPath::Indices;

// Messages belong to the piece before; a line on which only C turns is found though s stands.
TEST(ProgramPath, FindsThePieceOfEveryMove) {
  EXPECT_EQ(some_path().pieces_of(some_moves()), (Pieces{0, 0, 1, 1, 2, 2, 3}));
}

TEST(ProgramPath, FindsThePiecesOfRewrittenMoves) {
  const ProgramPath path = some_path();
  const Move rapid = move_to(at(9, 1), 1, 0, 10), half = move_to(at(10, 9), 3, 10, 20),
             rest = move_to(at(10, 21), 3, 20, 30), turn = move_to(at(10, 20, 40), 5, 30, 30),
             arc = move_to(at(9, 25, 90), 7, 30, 35);
  EXPECT_EQ(path.pieces_of(std::vector{rapid, half, rest, turn, turn, arc, arc}),
            (Pieces{0, 1, 1, 2, 2, 3, 3}));
  EXPECT_THROW(path.pieces_of(std::vector{arc, half}), std::logic_error);
}

TEST(ProgramPath, GivesThePositionByArcLength) {
  const ProgramPath path = some_path();
  expect_at(path.at(0, 0.0), at(0, 0));
  expect_at(path.at(0, 4 * mm), at(4, 0));
  expect_at(path.at(1, 15 * mm), at(10, 5));
  expect_at(path.at(1, 99.0), at(10, 20));  // clamped to the piece
  expect_at(path.at(2, 30 * mm), at(10, 20, 90));
  const double h = 10.0 * std::numbers::sqrt2 / 2.0;
  expect_at(path.at(3, (30 + 0.5 * kQuarter) * mm), at(h, 20 + h, 90));
}

// Beside a piece, past its end on the next one, before its begin on the one before.
TEST(ProgramPath, MeasuresTheDistanceToThePathNearby) {
  const ProgramPath path = some_path();
  const auto distance = [&](double x, double y, std::size_t piece) {
    return path.distance(Eigen::Vector3d(x, y, 0.0) * mm, piece) / mm;
  };
  constexpr double kTol = 1e-12;  // mm
  EXPECT_NEAR(distance(10.0, 7.0, 1), 0.0, kTol);
  EXPECT_NEAR(distance(10.3, 7.0, 1), 0.3, kTol);
  EXPECT_NEAR(distance(9.95, -0.02, 1), 0.02, kTol) << "the piece before is closer";
  EXPECT_NEAR(distance(9.5, 20.0 + std::sqrt(100.0 - 9.5 * 9.5), 1), 0.0, kTol) << "over the turn";
  EXPECT_NEAR(distance(0.0, 31.0, 3), 1.0, kTol);
  EXPECT_NEAR(distance(3.0, 24.0, 3), 5.0, kTol) << "inside of the arc";
}

// A zigzag while C turns, with an arc among every hundred lines.
std::vector<Move> many_moves(int count) {
  std::vector<Move> moves;
  double s = 0.0;
  for (int n = 0; n < count; ++n) {
    const AxisWords end = at(0.1 * (n % 700), 0.37 * n, n % 3 == 0 ? 1e-3 * n : 2.0);
    Move move = move_to(end, n + 1, s, s + 0.5);
    s += 0.5;
    if (n > 0 && n % 100 == 0) {
      move.kind = MoveKind::arc;
      const AxisWords& begin = moves.back().end;
      move.centre_machine = move.arc.centre = 0.5 * (begin + end).head<3>();
    }
    moves.push_back(std::move(move));
  }
  return moves;
}

TEST(ProgramPath, IsTheSameInMemoryAndOnTheDisk) {
  constexpr int kMoves = 70'000;
  const std::vector<Move> moves = many_moves(kMoves);
  const ProgramPath in_memory(moves, at(0, 0)), on_disk(moves, at(0, 0), nullptr, {}, 0);
  ASSERT_EQ(on_disk.size(), in_memory.size());
  EXPECT_EQ(on_disk.length(), in_memory.length());
  EXPECT_EQ(on_disk.pieces_of(moves), in_memory.pieces_of(moves));
  const Eigen::Vector3d aside(1 * mm, 2 * mm, 3 * mm);
  for (std::size_t i = 0; i < in_memory.size(); ++i) {
    const ProgramPath::Piece one = in_memory.piece(i), other = on_disk.piece(i);
    ASSERT_EQ(other.begin, one.begin) << i;
    ASSERT_EQ(other.end, one.end) << i;
    ASSERT_EQ(other.s_begin, one.s_begin) << i;
    ASSERT_EQ(other.s_end, one.s_end) << i;
    ASSERT_EQ(other.line, one.line) << i;
    ASSERT_EQ(on_disk.is_rapid(i), in_memory.is_rapid(i)) << i;
    const double s = 0.3 * one.s_begin + 0.7 * one.s_end;
    const AxisWords there = in_memory.at(i, s);
    ASSERT_EQ(on_disk.at(i, s), there) << i;
    const Eigen::Vector3d beside = there.head<3>() + aside;
    if (i % 500 != 0) continue;
    ASSERT_EQ(on_disk.distance(beside, i), in_memory.distance(beside, i)) << i;
  }
}

// As a recorder does it: a place now and then, pieces in between left out.
TEST(ProgramPath, GivesBackTheMemoryOfWhatLiesBehind) {
  constexpr int kMoves = 200'000;
  constexpr double kBytes = 48.0 * kMoves;  // of its pieces alone
  const ProgramPath path(many_moves(kMoves), at(0, 0), nullptr, {}, 0);
  const JointLayout layout{{Axis::X, Axis::Y, Axis::Z, Axis::B, Axis::C}};
  path.joints(1, 0.1, layout, Joints::Zero());
  const double before = mapped_bytes_in_memory();
  double most = 0.0;
  for (std::size_t i = 0; i < path.size(); i += 3) {
    path.joints(i, path.s_end(i), layout, Joints::Zero());
    if (i % 3000 == 0) most = std::max(most, mapped_bytes_in_memory() - before);
  }
  EXPECT_LT(most, 0.5 * kBytes);
}

}  // namespace
}  // namespace servomill::sim::engine::program_path_test
