// Limits of the axes under a path with an offset: what both demand together, and both sides of what
// is left.
#include "sim/preparation/offset_limits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bounded_path.h"

namespace servomill::sim::preparation::offset_limits_test {
namespace {

using namespace bounded_path;

TEST(OffsetDemands, OfAStandingPathAreTheDifferencesOfTheRows) {
  const Bounded bounded(standing(1.0), alike());
  const Series u = burst(bounded.rows(), 3 * um, 40.0, 0.5);
  const JointLimits demands = bounded.limits.demands(offset_of_X(u));
  EXPECT_NEAR(demands.v[0], largest(u, 1), kRoundingOf * largest(u, 1));
  EXPECT_NEAR(demands.a[0], largest(u, 2), kRoundingOf * largest(u, 2));
  EXPECT_NEAR(demands.j[0], largest(u, 3), kRoundingOf * largest(u, 3));
  EXPECT_EQ(demands.v.tail<4>(), Eigen::Vector4d::Zero());
}

TEST(OffsetDemands, CountWhatAnOffsetDoesAtItsEnds) {
  const Bounded bounded(standing(0.1), alike());
  for (const bool at_end : {false, true}) {
    Series u(bounded.rows(), 2 * um);
    (at_end ? u.back() : u.front()) = 3 * um;
    const JointLimits demands = bounded.limits.demands(offset_of_X(u));
    EXPECT_NEAR(demands.v[0], 1 * um / kRow, 1e-6 * um / kRow);
    EXPECT_NEAR(demands.a[0], 1 * um / (kRow * kRow), 1e-6 * um / (kRow * kRow)) << "then it rests";
    EXPECT_NEAR(demands.j[0], 2 * um / std::pow(kRow, 3), 1e-6 * um / std::pow(kRow, 3));
  }
}

TEST(OffsetDemands, OfNoOffsetAreThoseOfThePath) {
  constexpr double kFeed = 0.4;
  const Bounded bounded(moving(0.4, kFeed), alike(), 0.05);
  const JointLimits demands =
      bounded.limits.demands(std::vector<Joints>(bounded.rows(), Joints::Constant(5 * um)));
  EXPECT_NEAR(demands.v[0], kFeed, kRoundingOf);
  EXPECT_NEAR(demands.a[0], std::sqrt(kFeed * kJ) < kA ? std::sqrt(kFeed * kJ) : kA, 1e-6);
  EXPECT_NEAR(demands.j[0], kJ, 1e-6);
  EXPECT_LE(demands.v.tail<4>().norm(), kRoundingOf);
}

// An offset that rises in the direction of travel adds, against it it takes away.
TEST(OffsetDemands, AddThoseOfPathAndOffset) {
  constexpr double kFeed = 0.1, kSlope = 2 * mm;  // m/s
  const Trajectory path = moving(0.1, kFeed);
  const Bounded bounded(path, alike(), 0.05);
  Series u(bounded.rows(), 0.0);
  for (std::size_t n = 0; n < u.size(); ++n) {
    const double t = static_cast<double>(n) * kRow - 0.5 * path.duration();
    u[n] = kSlope * std::clamp(t, -0.1, 0.1);
  }
  EXPECT_NEAR(bounded.limits.demands(offset_of_X(u)).v[0], kFeed + kSlope, kRoundingOf);
  for (double& one : u) one = -one;
  EXPECT_NEAR(bounded.limits.demands(offset_of_X(u)).v[0], kFeed, kRoundingOf);
}

// A difference acts as a control point of the velocity from one row before to one behind its two,
// as the jerk between its two middle rows.
TEST(OffsetDemands, AreThoseOfPathAndOffsetAtTheSameTime) {
  const Trajectory path = moving(0.4, 0.4);
  const Bounded bounded(path, alike(), 0.05);
  constexpr std::size_t kSpeedsUp = 65, kSlowsDown = 79;  // ms: from 50 to 80 at constant 5 m/s^2
  Trajectory::Cursor cursor{};
  Series step(bounded.rows(), 0.0);
  for (std::size_t n = kSpeedsUp + 1; n < step.size(); ++n) step[n] = 1.0 * kRow;
  EXPECT_NEAR(bounded.limits.demands(offset_of_X(step)).v[0],
              1.0 + path.at((kSpeedsUp + 2) * kRow, cursor).dQ_ref[0], kRoundingOf);
  const double jerk = 0.5 * kJ * std::pow(kRow, 3);
  ASSERT_NEAR(path.at(kSlowsDown * kRow, cursor).dddQ_ref[0], 0.0, 1e-6);
  ASSERT_NEAR(path.at((kSlowsDown + 1.01) * kRow, cursor).dddQ_ref[0], -kJ, 1e-6);
  EXPECT_NEAR(bounded.limits.demands(offset_of_X(with_one_jerk(bounded.rows(), 79, -jerk))).j[0],
              1.5 * kJ, 1e-6 * kJ);
  EXPECT_LT(bounded.limits.demands(offset_of_X(with_one_jerk(bounded.rows(), 65, -jerk))).j[0],
            1.1 * kJ);
}

// The cubic between two rows, by four of its points.
struct Piece {
  double c[4];
  Piece(const strategies::PathOffset& offset, double row) {
    const auto y = [&](double f) { return offset.at((row + f) * kEvery)[0]; };
    const double a = y(0.0), b = y(1.0 / 3.0), d = y(2.0 / 3.0), e = y(1.0);
    c[0] = a;
    c[1] = -5.5 * a + 9.0 * b - 4.5 * d + e;
    c[2] = 9.0 * a - 22.5 * b + 18.0 * d - 4.5 * e;
    c[3] = -4.5 * a + 13.5 * b - 13.5 * d + 4.5 * e;
  }
  double v(double f) const { return (c[1] + f * (2.0 * c[2] + 3.0 * f * c[3])) / kRow; }
  double a(double f) const { return (2.0 * c[2] + 6.0 * f * c[3]) / (kRow * kRow); }
  double j() const { return 6.0 * c[3] / (kRow * kRow * kRow); }
};

// Law: at no position period do the derivatives of path and offset exceed what is demanded, also
// where the jerk of the path changes between two rows.
TEST(OffsetDemands, AreNeverExceededBetweenRows) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (const bool moves : {false, true}) {
      const Trajectory path = moves ? moving(0.02, 0.1) : standing(0.3);
      const Bounded bounded(path, alike());
      Series u(bounded.rows(), 0.0);
      for (std::size_t n = 1; n < u.size(); ++n) u[n] = 0.9 * u[n - 1] + 0.01 * um * normal(random);
      const JointLimits demands = bounded.limits.demands(offset_of_X(u));
      const strategies::PathOffset offset{std::make_shared<const PathTimes>(bounded.times),
                                          offset_of_X(u)};
      Trajectory::Cursor cursor{};
      for (std::size_t n = 0; n + 1 < u.size(); ++n) {
        const auto row = static_cast<double>(n);
        const Piece piece(offset, row);
        for (std::size_t k = 0; k < kEvery; ++k) {
          const double f = static_cast<double>(k) / kEvery;
          const auto at = path.at((row + f) * kRow, cursor);
          ASSERT_LE(std::abs(at.dQ_ref[0] + piece.v(f)), demands.v[0] * (1.0 + kRoundingOf))
              << "seed " << seed << ", row " << n;
          ASSERT_LE(std::abs(at.ddQ_ref[0] + piece.a(f)), demands.a[0] * (1.0 + 1e-6))
              << "seed " << seed << ", row " << n;
          ASSERT_LE(std::abs(at.dddQ_ref[0] + piece.j()), demands.j[0] * (1.0 + 1e-6))
              << "seed " << seed << ", row " << n;
        }
      }
    }
  }
}

TEST(RestAtEnds, HoldsBothEndsAndLeavesWhatIsFurtherAway) {
  const Bounded bounded(standing(0.5), alike());
  Series u;
  for (std::size_t n = 0; n < bounded.rows(); ++n) {
    u.push_back(um * std::sin(0.05 * static_cast<double>(n)) + 2 * um);
  }
  const std::vector<Joints> before = offset_of_X(u);
  std::vector<Joints> after = before;
  bounded.limits.rest_at_ends(after, 0.05);
  const std::size_t last = u.size() - 1;
  EXPECT_EQ(after.front(), before.front());
  EXPECT_EQ(after.back(), before.back());
  for (std::size_t n = 0; n <= 3; ++n) {
    EXPECT_EQ(after[n], before.front()) << "a third difference reaches that far";
    EXPECT_EQ(after[last - n], before.back());
  }
  for (std::size_t n = 55; n + 55 <= last; ++n) EXPECT_EQ(after[n], before[n]) << n;
  for (std::size_t n = 0; n <= last; ++n) {
    EXPECT_EQ(after[n].tail<4>(), Eigen::Vector4d::Zero());
    EXPECT_LE((after[n] - before[n]).norm(), 2 * um);
  }
}

TEST(RestAtEnds, OfAShortOffsetMeetInItsMiddle) {
  const Bounded bounded(standing(0.02), alike());
  Series u(bounded.rows(), 1 * um);
  u.front() = 0.0;
  u.back() = 3 * um;
  std::vector<Joints> after = offset_of_X(u);
  bounded.limits.rest_at_ends(after, 0.05);
  for (std::size_t n = 1; n < u.size(); ++n) {
    EXPECT_GE(after[n][0], after[n - 1][0]) << n;  // from one end to the other
  }
  EXPECT_EQ(after.front()[0], 0.0);
  EXPECT_EQ(after.back()[0], 3 * um);
}

// Both sides of the limit, of each order.
TEST(NearestWithin, ReturnsAnOffsetWithinItsLimitsBitForBit) {
  const Trajectory path = standing(1.0);
  const Series u = burst(Bounded(path, alike()).rows(), 3 * um, 40.0, 0.5);
  for (const std::size_t order : {1U, 2U, 3U}) {
    const auto limits = [&](double share) {
      const double limit = largest(u, order) / share;
      return alike(order == 1 ? limit : 1e3, order == 2 ? limit : 1e6, order == 3 ? limit : 1e9);
    };
    const Bounded within(path, limits(1.0 - kBesides)), beyond(path, limits(1.01));
    EXPECT_EQ(X_of(within.limits.nearest_within(offset_of_X(u))), u) << order;
    const std::vector<Joints> near = beyond.limits.nearest_within(offset_of_X(u));
    EXPECT_NE(X_of(near), u) << order;
    EXPECT_TRUE(keeps(beyond.limits.demands(near), limits(1.01))) << order;
  }
}

TEST(NearestWithin, LeavesAnAxisThatTheMachineLacks) {
  const Bounded bounded(standing(1.0), of_X());
  const Series u = burst(bounded.rows(), 30 * um, 40.0, 0.5);
  std::vector<Joints> offset;
  for (const double one : u) offset.push_back(Joints::Constant(one));
  const std::vector<Joints> near = bounded.limits.nearest_within(offset);
  for (std::size_t n = 0; n < u.size(); ++n) EXPECT_EQ(near[n].tail<4>(), offset[n].tail<4>());
  EXPECT_NE(X_of(near), u);
}

// One burst exceeds the jerk, another one does not.
TEST(NearestWithin, ChangesRowsWithinAQuarterOfASecondOnly) {
  const Bounded bounded(standing(3.0), alike());
  const Series strong = burst(bounded.rows(), 8 * um, 50.0, 1.0),
               weak = burst(bounded.rows(), 1 * um, 50.0, 2.0);
  Series u = strong;
  for (std::size_t n = 0; n < u.size(); ++n) u[n] += weak[n];
  std::size_t first = u.size(), last = 0;
  for (std::size_t n = 1; n + 2 < u.size(); ++n) {
    if (std::abs(difference(u, 3, n)) <= kJ * kRow * kRow * kRow) continue;
    first = std::min(first, n);
    last = n;
  }
  ASSERT_LT(first, last);
  const std::vector<Joints> near = bounded.limits.nearest_within(offset_of_X(u));
  const auto around = static_cast<std::size_t>(kAround / kRow) + 3;
  int changed = 0;
  for (std::size_t n = 0; n < u.size(); ++n) {
    if (n + around < first || n > last + around) {
      EXPECT_EQ(near[n][0], u[n]) << n;
    } else if (near[n][0] != u[n]) {
      ++changed;
    }
  }
  EXPECT_GT(changed, 50);
  EXPECT_TRUE(keeps(bounded.limits.demands(near), alike()));
}

TEST(NearestWithin, BringsOffsetsOfAnySizeWithinLimits) {
  for (const double A : {2.0, 5.0, 20.0, 100.0}) {  // um
    for (const double f : {10.0, 30.0, 60.0}) {
      for (const bool moves : {false, true}) {
        const Bounded bounded(moves ? moving(0.5, 0.4) : standing(1.5), alike());
        const std::vector<Joints> near =
            bounded.limits.nearest_within(offset_of_X(burst(bounded.rows(), A * um, f, 0.7, 0.2)));
        const JointLimits demands = bounded.limits.demands(near);
        EXPECT_TRUE(keeps(demands, alike())) << A << " um, " << f << " Hz: " << demands.v[0] << " "
                                             << demands.a[0] << " " << demands.j[0];
      }
    }
  }
}

TEST(OffsetLimits, AreKeptUpToRounding) {
  const JointLimits limits = alike();
  for (int order = 0; order < 3; ++order) {
    for (int j = 0; j < kJoints; ++j) {
      const auto demands = [&](double share) {
        JointLimits out = limits;
        (order == 0 ? out.v : order == 1 ? out.a : out.j)[j] *= share;
        return out;
      };
      EXPECT_TRUE(keeps(demands(0.0), limits));
      EXPECT_TRUE(keeps(demands(1.0), limits));
      EXPECT_TRUE(keeps(demands(1.0 + 0.99 * kRounding), limits));
      EXPECT_FALSE(keeps(demands(1.0 + 1.01 * kRounding), limits));
    }
  }
  EXPECT_TRUE(keeps(alike(), {alike().v, alike().a, Joints::Unit(0) * kJ}))
      << "what the machine lacks has no limit";
}

TEST(OffsetLimits, AreLoweredByWhatIsDemandedTooMuch) {
  const JointLimits limits = alike(), planned = alike(0.3, 4.0, 80.0);
  JointLimits demands = limits;
  const JointLimits same = lowered(planned, demands, limits);
  EXPECT_EQ(same.v, planned.v);
  EXPECT_EQ(same.a, planned.a);
  EXPECT_EQ(same.j, planned.j);
  demands.v[1] *= 1.25;
  demands.a[2] *= 2.0;
  demands.j[0] *= 1.0001;
  const JointLimits lower = lowered(planned, demands, limits);
  EXPECT_NEAR(lower.v[1], 0.98 * 0.3 / 1.25, kRoundingOf);
  EXPECT_NEAR(lower.a[2], 0.98 * 4.0 / 2.0, kRoundingOf);
  EXPECT_NEAR(lower.j[0], 0.98 * 80.0 / 1.0001, kRoundingOf);
  EXPECT_EQ(lower.v[0], planned.v[0]);
  EXPECT_EQ(lower.a[1], planned.a[1]);
  EXPECT_EQ(lower.j[4], planned.j[4]);
}

TEST(OffsetLimits, AreNotLoweredBelowATenth) {
  const JointLimits limits = alike();
  const auto lower = [&](double share) {
    JointLimits demands = limits;
    demands.j[3] *= share;
    return lowered(limits, demands, limits).j[3];
  };
  EXPECT_NEAR(lower(9.7), kJ * 0.98 / 9.7, kRoundingOf);
  EXPECT_NEAR(lower(9.9), 0.1 * kJ, kRoundingOf);
  EXPECT_NEAR(lower(1e6), 0.1 * kJ, kRoundingOf);
}

}  // namespace
}  // namespace servomill::sim::preparation::offset_limits_test
