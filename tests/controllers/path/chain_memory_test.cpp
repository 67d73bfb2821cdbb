/// Motions that come again are planned once and have the bits of their own plan.
#include "controllers/path/chain_memory.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>

#include "programs.h"
#include "tests/counting_new.h"

namespace servomill::controllers::test::chain_memory_test {
namespace {

// A part: a contour with an arc, and rapids back to its start.
void add_part(Program& program, double feed = 0.05) {
  program.line(0.02, 0.0, 0.0, feed);
  program.arc({0.02, 0.01, 0.0}, {0.02, 0.02, 0.0}, 2, 1, feed);
  program.line(0.0, 0.01, 0.0, feed);
  program.dwell(0.1);
  AxisWords home = AxisWords::Zero();
  home[2] = 0.05;
  program.rapid(home);
  program.rapid(AxisWords::Zero());
}

Program parts(int count) {
  Program program;
  for (int n = 0; n < count; ++n) add_part(program);
  return program;
}

bool has_same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void expect_same_bits(const Joints& a, const Joints& b) {
  for (int j = 0; j < kJoints; ++j) EXPECT_TRUE(has_same_bits(a[j], b[j]));
}

TEST(RepeatedParts, HaveTheBitsOfOnePart) {
  const Trajectory one = parts(1).plan(), many = parts(20).plan();
  const std::size_t each = one.chains();
  ASSERT_EQ(many.chains(), 20 * each);
  for (std::size_t n = 0; n < many.chains(); ++n) {
    const auto one_of_many = many.chain(n), of_one = one.chain(n % each);
    const Trajectory::Chain &mine = *one_of_many, &alone = *of_one;
    EXPECT_TRUE(has_same_bits(mine.duration, alone.duration));
    ASSERT_EQ(mine.plan == nullptr, alone.plan == nullptr);
    if (mine.plan == nullptr) continue;
    ASSERT_EQ(mine.plan->path.pieces.size(), alone.plan->path.pieces.size());
    for (std::size_t i = 0; i < mine.plan->path.pieces.size(); ++i) {
      const CubicPiece &a = mine.plan->path.pieces[i], &b = alone.plan->path.pieces[i];
      EXPECT_TRUE(has_same_bits(a.s, b.s));
      expect_same_bits(a.c0, b.c0);
      expect_same_bits(a.c1, b.c1);
      expect_same_bits(a.c2, b.c2);
      expect_same_bits(a.c3, b.c3);
    }
    ASSERT_EQ(mine.plan->law.phases.size(), alone.plan->law.phases.size());
    for (std::size_t i = 0; i < mine.plan->law.phases.size(); ++i) {
      EXPECT_TRUE(has_same_bits(mine.plan->law.phases[i].t, alone.plan->law.phases[i].t));
    }
  }
}

TEST(RepeatedParts, ArePlannedTwice) {
  const Trajectory many = parts(20).plan();
  std::set<const void*> plans;
  for (std::size_t n = 0; n < many.chains(); ++n) {
    const auto held = many.chain(n);
    const Trajectory::Chain& chain = *held;
    if (chain.plan != nullptr) plans.insert(chain.plan.get());
  }
  const std::size_t of_one = parts(1).plan().chains() - 1;  // without its dwell
  EXPECT_EQ(plans.size(), 2 * of_one);
}

// Each sample knows the move of its own part.
TEST(RepeatedParts, GoAlongTheirOwnMoves) {
  const Program program = parts(5);
  const Trajectory path = program.plan();
  const std::size_t each = program.moves().size() / 5;
  Trajectory::Cursor cursor;
  const double of_one = path.duration() / 5.0;
  for (int part = 0; part < 5; ++part) {
    const auto now = path.at((part + 0.01) * of_one, cursor);
    EXPECT_EQ(now.move / each, static_cast<std::size_t>(part));
    EXPECT_GE(now.s, program.moves()[part * each].s_begin);
  }
}

TEST(MotionsThatDiffer, HavePlansOfTheirOwn) {
  Program program;
  for (const double feed : {0.05, 0.05, 0.05, 0.06, 0.06, 0.06}) add_part(program, feed);
  const Trajectory path = program.plan();
  const std::size_t each = path.chains() / 6;
  EXPECT_EQ(path.chain(each)->plan, path.chain(2 * each)->plan);
  EXPECT_NE(path.chain(2 * each)->plan, path.chain(3 * each)->plan);
  EXPECT_GT(path.chain(2 * each)->duration, path.chain(5 * each)->duration);
}

// Memory of 900 parts more: moves and spans, not paths and laws.
TEST(RepeatedParts, TakeLittleMemoryEach) {
  const auto held = [](int count) {
    const Program program = parts(count);
    const std::size_t before = bytes_in_use;
    const Trajectory path = program.plan();
    return static_cast<double>(bytes_in_use - before);
  };
  constexpr double kEach = 3000.0;  // bytes; a plan of one part takes ten times that
  const double of_one = held(1), of_hundred = held(100), of_thousand = held(1000);
  EXPECT_GT(of_one, 10.0 * kEach);
  EXPECT_LT((of_thousand - of_hundred) / 900.0, kEach);
}

}  // namespace
}  // namespace servomill::controllers::test::chain_memory_test
