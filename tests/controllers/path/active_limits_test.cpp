#include "controllers/path/active_limits.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <utility>

#include "plant/vocabulary/units.h"
#include "programs.h"

namespace servomill::controllers::test::active_limits_test {
namespace {

constexpr double kRounding = 1e-9;  // s, of sums over some thousand stretches

using Times = std::map<std::pair<LimitKind, int>, double>;

JointLimits alike(double v, double a, double j) {
  return {Joints::Constant(v), Joints::Constant(a), Joints::Constant(j)};
}

Times times_of(const Program& program, const PathOptions& options, const JointLimits& limits) {
  const Trajectory trajectory = program.plan(options, limits);
  Times out;
  for_each_stretch(program.moves(), trajectory, limits, options, [&](const MotionStretch& stretch) {
    out[{stretch.kind, stretch.joint}] += stretch.time;
  });
  return out;
}

double sum_of(const Times& times, LimitKind kind) {
  double sum = 0.0;
  for (const auto& [limit, time] : times) sum += limit.first == kind ? time : 0.0;
  return sum;
}

AxisWords to_x(double x) {
  AxisWords words = AxisWords::Zero();
  words[0] = x;
  return words;
}

// From rest to v and back an S-curve spends 4 a/j at its jerk and 2 (v/a - a/j) at its
// acceleration.
TEST(ActiveLimits, OfARapidAreThoseOfItsSCurve) {
  const double v = 0.5, a = 2.0, j = 50.0, d = 0.4;
  const Times times = times_of(Program().rapid(to_x(d)), {}, alike(v, a, j));
  EXPECT_NEAR(times.at({LimitKind::jerk, 0}), 4.0 * a / j, kRounding);
  EXPECT_NEAR(times.at({LimitKind::acceleration, 0}), 2.0 * (v / a - a / j), kRounding);
  EXPECT_NEAR(times.at({LimitKind::velocity, 0}), d / v - v / a - a / j, kRounding);
  EXPECT_EQ(times.size(), 3u);
}

TEST(ActiveLimits, AFeedThatIsReachedIsTheLimit) {
  const double v = 0.1, a = 2.0, j = 50.0, d = 0.4;
  const Times times = times_of(Program().line(d, 0, 0, v), {}, alike(1.0, a, j));
  EXPECT_NEAR(times.at({LimitKind::feed, -1}), d / v - v / a - a / j, kRounding);
  EXPECT_EQ(sum_of(times, LimitKind::velocity), 0.0);
}

TEST(ActiveLimits, AnOverrideMovesTheLimitFromTheFeedToTheAxis) {
  PathOptions options;
  options.feed_override = 100.0;
  const Times times = times_of(Program().line(0.4, 0, 0, 0.1), options, alike(0.5, 2.0, 50.0));
  EXPECT_EQ(sum_of(times, LimitKind::feed), 0.0);
  EXPECT_GT(times.at({LimitKind::velocity, 0}), 0.1);
}

TEST(ActiveLimits, NameTheWeakestAxis) {
  JointLimits limits = alike(1.0, 5.0, 100.0);
  limits.v[1] = 0.1;
  const Times times = times_of(Program().line(0.3, 0.3, 0, 10.0), {}, limits);
  EXPECT_GT(times.at({LimitKind::velocity, 1}), 2.5);
  EXPECT_FALSE(times.contains({LimitKind::velocity, 0}));
}

TEST(ActiveLimits, ARotaryAxisCountsInItsOwnUnits) {
  JointLimits limits = alike(1.0, 5.0, 100.0);
  limits.v[4] = 0.5;  // rad/s
  AxisWords to = to_x(0.1);
  to[index_of(Axis::C)] = 1.0;
  PathOptions options;
  options.rotary_radius = 0.37;
  const Times times = times_of(Program().line(to, 1.0), options, limits);
  EXPECT_NEAR(times.at({LimitKind::velocity, 4}), 2.0, 0.3);
}

TEST(ActiveLimits, ABlockTimeBoundsShortBlocks) {
  Program program;
  for (int i = 1; i <= 1000; ++i) program.line(i * 0.1 * mm, 0, 0, 0.1);
  PathOptions options;
  options.block_time = 4 * ms;  // 0.025 m/s
  const Times times = times_of(program, options, alike(1.0, 5.0, 100.0));
  EXPECT_NEAR(times.at({LimitKind::block_time, -1}), 4.0, 0.1);
  EXPECT_EQ(sum_of(times, LimitKind::feed), 0.0);
}

// Straight blocks along a polygon, at a feed that only its corners stop.
Program polygon() {
  Program program;
  constexpr int kCorners = 40;
  for (int i = 1; i <= kCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    program.line(10 * mm * std::sin(angle), 10 * mm * (1.0 - std::cos(angle)), 0, 1.0);
  }
  return program;
}

TEST(ActiveLimits, CornersCountWhereStraightBlocksAreRounded) {
  const Times times = times_of(polygon(), {}, alike(1.0, 5.0, 100.0));
  double all = 0.0;
  for (const auto& [limit, time] : times) all += time;
  EXPECT_GT(sum_of(times, LimitKind::corner), 0.3 * all);
  EXPECT_GT(times.at({LimitKind::corner, 0}), 0.0);
  EXPECT_GT(times.at({LimitKind::corner, 1}), 0.0);
}

TEST(ActiveLimits, TheCurvatureOfAnArcIsNoCorner) {
  const double r = 20 * mm, a = 2.0;
  Program program;
  program.arc({0, r, 0}, {0, 0, 0}, 2, 5, 1.0);
  const Times times = times_of(program, {}, alike(10.0, a, 1e4));
  EXPECT_EQ(sum_of(times, LimitKind::corner), 0.0);
  // somewhere on a circle one of two axes needs all of v^2/r, anywhere 70 % of it
  EXPECT_GT(times.at({LimitKind::acceleration, 0}), 0.0);
  EXPECT_GT(times.at({LimitKind::acceleration, 1}), 0.0);
}

TEST(ActiveLimits, ADwellHasNone) {
  Program program;
  program.line(0.01, 0, 0, 0.1).dwell(0.5).line(0.02, 0, 0, 0.1);
  const Times times = times_of(program, {}, alike(1.0, 5.0, 100.0));
  EXPECT_NEAR(times.at({LimitKind::none, -1}), 0.5, kRounding);
}

class RandomPrograms : public ::testing::TestWithParam<unsigned> {};

TEST_P(RandomPrograms, TimesAddUpToTheDuration) {
  const Program program = random_program(GetParam());
  const Trajectory trajectory = program.plan();
  double sum = 0.0;
  std::size_t last = 0;
  for_each_stretch(program.moves(), trajectory, machine_limits(), {},
                   [&](const MotionStretch& stretch) {
                     EXPECT_GT(stretch.time, 0.0);
                     EXPECT_GE(stretch.move, last);
                     EXPECT_EQ(stretch.joint >= 0, is_of_joint(stretch.kind));
                     last = stretch.move;
                     sum += stretch.time;
                   });
  EXPECT_NEAR(sum, trajectory.duration(), kRounding * std::max(1.0, trajectory.duration()));
}

// The time of a move is that in which samples of the trajectory are on it.
TEST_P(RandomPrograms, TimesOfMovesAreThoseOfTheSamples) {
  const Program program = random_program(GetParam());
  const Trajectory trajectory = program.plan();
  std::map<std::size_t, double> booked, sampled;
  for_each_stretch(program.moves(), trajectory, machine_limits(), {},
                   [&](const MotionStretch& stretch) { booked[stretch.move] += stretch.time; });
  const double dt = 0.1 * ms;
  Trajectory::Cursor cursor;
  for (double t = 0.5 * dt; t < trajectory.duration(); t += dt) {
    sampled[trajectory.at(t, cursor).move] += dt;
  }
  for (const auto& [move, time] : sampled) EXPECT_NEAR(booked[move], time, 2.0 * dt) << move;
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomPrograms, ::testing::Range(1u, 21u));

}  // namespace
}  // namespace servomill::controllers::test::active_limits_test
