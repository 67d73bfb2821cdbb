#include "controllers/path/collected_motion.h"

#include <gtest/gtest.h>

namespace servomill::controllers::collected_motion_test {
namespace {

Joints at(double x, double y = 0.0) {
  Joints u = Joints::Zero();
  u[0] = x, u[1] = y;
  return u;
}

void add(CollectedMotion& motion, const Joints& u, int arc = -1) {
  motion.vertices.push_back({u, 1e-5, 1e-5, 0.1, arc});
}

// Move 0 of one chord; move 1 of three chords of 1, 2 and 1 mm, each a part with a time of its own.
CollectedMotion two_moves() {
  CollectedMotion motion;
  motion.start_at(at(0.0));
  ChainSpeeds::Span span = motion.begin_span(Move{}, 0);
  span.feed = motion.speeds.index_of({.linear = 0.1});
  add(motion, at(1e-3));
  span.last = motion.last_vertex();
  motion.speeds.spans.push_back(span);
  double from = 0.0;
  for (const double to : {0.25, 0.75, 1.0}) {
    span = motion.begin_span(Move{}, 1);
    span.feed = motion.speeds.index_of({.linear = 0.2});
    add(motion, at(1e-3 + 4e-3 * to));
    motion.end_part(span, from, to, 2.0 * (to - from));
    from = to;
  }
  return motion;
}

TEST(CollectedMotion, IsDividedWithTheSharesOfItsMoves) {
  CollectedMotion behind = two_moves();
  const CollectedMotion before = behind.take_before(2);  // in the middle of move 1
  ASSERT_EQ(before.vertices.size(), 4U);
  EXPECT_EQ(before.last_u(), at(3e-3));
  EXPECT_EQ(behind.vertices.u(0), at(3e-3));
  ASSERT_EQ(before.speeds.spans.size(), 3U);
  ASSERT_EQ(behind.speeds.spans.size(), 2U);
  EXPECT_EQ(before.speeds.time_of(before.speeds.spans[0]), 0.0);
  EXPECT_EQ(before.speeds.feeds[before.speeds.spans[0].feed].linear, 0.1);
  const auto share = [](const CollectedMotion& motion, std::size_t n) {
    return motion.shares[motion.speeds.spans[n].share];
  };
  EXPECT_EQ(share(before, 2).from, 0.25);
  EXPECT_EQ(share(before, 2).to, 0.5);
  EXPECT_DOUBLE_EQ(before.speeds.time_of(before.speeds.spans[2]), 0.5);
  EXPECT_EQ(share(behind, 0).from, 0.5);
  EXPECT_EQ(share(behind, 0).to, 0.75);
  EXPECT_EQ(share(behind, 1).to, 1.0);
  EXPECT_DOUBLE_EQ(behind.speeds.time_of(behind.speeds.spans[0]), 0.5);
  EXPECT_EQ(behind.speeds.spans[0].first, 0U);
  EXPECT_EQ(behind.speeds.spans[0].last, 1U);
  EXPECT_EQ(behind.speeds.spans[1].last, 2U);
  EXPECT_EQ(behind.speeds.feeds[behind.speeds.spans[1].feed].linear, 0.2);
}

TEST(CollectedMotion, AMoveOfOneChordIsDividedInHalves) {
  CollectedMotion behind = two_moves();
  const CollectedMotion before = behind.take_before(0);
  ASSERT_EQ(before.shares.size(), 1U);
  EXPECT_EQ(before.shares[0].to, 0.5);
  EXPECT_EQ(behind.shares[0].from, 0.5);
  EXPECT_EQ(behind.shares[0].to, 1.0);
  EXPECT_EQ(behind.speeds.spans[0].move, 0U);
  EXPECT_EQ(behind.speeds.spans[3].move, 1U);
}

// The smoothed path moves points of arcs: at the seam they stay, so that both parts go on in the
// direction of the chord.
TEST(CollectedMotion, PointsOfAnArcAtTheSeamStay) {
  CollectedMotion behind;
  behind.start_at(at(0.0));
  for (int n = 1; n < 6; ++n) add(behind, at(n * 1e-3, n * n * 1e-5), 7);
  const CollectedMotion before = behind.take_before(3);
  EXPECT_EQ(before.vertices.traits(2).arc, 7);
  EXPECT_EQ(before.vertices.traits(3).arc, -1);
  EXPECT_EQ(before.vertices.traits(4).arc, -1);
  EXPECT_EQ(behind.vertices.traits(1).arc, -1);
  EXPECT_EQ(behind.vertices.traits(2).arc, 7);
}

TEST(CollectedMotion, TheSeamLiesOnTheLongestStraightChord) {
  CollectedMotion motion;
  motion.start_at(at(0.0));
  double x = 0.0, y = 0.0;
  for (int n = 1; n < 40; ++n) {
    x += n == 30 || n == 5 ? 1e-3 : 1e-4;
    y += n == 33 ? 0.0 : 1e-6 * (n % 3);
    add(motion, at(x, y));
  }
  EXPECT_EQ(motion.seam(), 29U);  // not 4: of the first half
}

TEST(CollectedMotion, SplinesHaveNoSeam) {
  CollectedMotion motion;
  motion.start_at(at(0.0));
  for (int n = 1; n < 40; ++n) {
    motion.vertices.push_back({at(n * 1e-3), 1e-5, 1e-5, 0.0, 3, true});
  }
  EXPECT_FALSE(motion.seam());
}

}  // namespace
}  // namespace servomill::controllers::collected_motion_test
