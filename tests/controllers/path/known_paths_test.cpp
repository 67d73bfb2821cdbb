/// Motions with a known answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controllers/path/trajectory.h"
#include "programs.h"
#include "tests/counting_new.h"

namespace servomill::controllers::test::known_paths_test {
namespace {

constexpr double kRounding = 1e-9;  // of the quantity, rounding of sums along the path

JointLimits alike(double v, double a, double j) {
  return {Joints::Constant(v), Joints::Constant(a), Joints::Constant(j)};
}

template <class F>
void each_sample(const Trajectory& path, double dt, F&& f) {
  Trajectory::Cursor cursor;
  for (int n = 0; n * dt <= path.duration(); ++n) f(n * dt, path.at(n * dt, cursor));
}

TEST(OneLine, TakesTheTimeOfTheSCurveWithConstantAcceleration) {
  const double v = 0.5, a = 2.0, j = 50.0, d = 0.4;
  const Trajectory path = Program().line(d, 0, 0, v).plan({}, alike(1.0, a, j));
  EXPECT_NEAR(path.duration(), d / v + v / a + a / j, kRounding);
}

TEST(OneLine, TakesTheTimeOfTheSCurveThatReachesNoConstantAcceleration) {
  const double v = 0.02, a = 2.0, j = 50.0, d = 0.01;
  const Trajectory path = Program().line(0, d, 0, v).plan({}, alike(1.0, a, j));
  EXPECT_NEAR(path.duration(), d / v + 2.0 * std::sqrt(v / j), kRounding);
}

TEST(OneLine, TooShortForItsFeedIsLimitedByJerkAlone) {
  const double j = 50.0, d = 10 * um;
  const Trajectory path = Program().line(0, 0, d, 1.0).plan({}, alike(1.0, 2.0, j));
  EXPECT_NEAR(path.duration(), std::cbrt(32.0 * d / j), 1e-6 * path.duration());  // peak search
}

TEST(OneLine, IsLimitedByTheWeakestAxisOfItsDirection) {
  JointLimits limits = alike(1.0, 5.0, 100.0);
  limits.v[1] = 0.1;
  const Trajectory path = Program().line(0.3, 0.3, 0, 10.0).plan({}, limits);
  double fastest = 0.0;
  each_sample(path, 1 * ms, [&](double, const auto& x) {
    fastest = std::max(fastest, x.dQ_ref[0]);
    EXPECT_NEAR(x.dQ_ref[0], x.dQ_ref[1], kRounding);
  });
  EXPECT_NEAR(fastest, 0.1, kRounding);
}

// The limits of axes that a machine does not have are 0.
TEST(Corners, AreTheSameOnAMachineWithoutRotaryAxes) {
  JointLimits three_axes = machine_limits();
  for (Joints* limits : {&three_axes.v, &three_axes.a, &three_axes.j}) limits->tail<2>().setZero();
  PathOptions narrow, wide;
  narrow.tolerance = 0.2 * um;  // a stop is quicker than the rounding
  wide.tolerance = 1.0 * mm;
  for (const PathOptions& options : {narrow, wide}) {
    const Program corner = Program().line(0.1, 0, 0, 0.1).line(0.1, 0.1, 0, 0.1);
    const Trajectory three = corner.plan(options, three_axes), five = corner.plan(options);
    EXPECT_EQ(three.duration(), five.duration());
    EXPECT_EQ(three.chains(), five.chains());
    EXPECT_EQ(three.chains(), options.tolerance < 1 * um ? 2U : 1U);
  }
}

TEST(OneLine, DoesNotDependOnHowFinelyItIsCut) {
  const double whole = Program().line(0.05, 0.03, 0, 0.1).plan().duration();
  for (const int n : {2, 10, 1000}) {
    Program program;
    for (int i = 1; i <= n; ++i) program.line(0.05 * i / n, 0.03 * i / n, 0, 0.1);
    EXPECT_NEAR(program.plan().duration(), whole, 1e-6 * whole) << n;
  }
}

TEST(OneLine, KnowsWhereItIs) {
  Program program;
  program.line(0.01, 0, 0, 0.1).dwell(0.5).line(0.01, 0.02, 0, 0.1);
  const Trajectory path = program.plan();
  each_sample(path, 1 * ms, [&](double, const auto& x) {
    EXPECT_NEAR(x.s, x.Q_ref[0] + x.Q_ref[1], 1e-12);
    EXPECT_EQ(x.line, x.Q_ref[1] > 0.0 ? 3 : x.dQ_ref[0] > 0.0 || x.s < 0.01 ? 1 : x.line);
  });
  Trajectory::Cursor cursor;
  EXPECT_EQ(path.at(path.duration() / 2, cursor).line, 2);
  EXPECT_EQ(path.at(-1.0, cursor).line, 1);
  EXPECT_EQ(path.at(path.duration() + 1.0, cursor).line, 3);
  EXPECT_EQ(path.at(path.duration() + 1.0, cursor).s, 0.03);
}

TEST(OneLine, ReadsTheSameForwardsAndBackwards) {
  const Trajectory path = random_program(7).plan();
  Trajectory::Cursor forward, backward;
  const int n = 2000;
  std::vector<Joints> Q;
  for (int k = 0; k <= n; ++k) Q.push_back(path.at(path.duration() * k / n, forward).Q_ref);
  for (int k = n; k >= 0; --k) {
    EXPECT_EQ(path.at(path.duration() * k / n, backward).Q_ref, Q[static_cast<std::size_t>(k)]);
  }
}

TEST(OneLine, IsReadWithoutAllocation) {
  const Trajectory path = random_program(3).plan();
  Trajectory::Cursor cursor;
  const std::size_t before = allocations;
  for (double t = 0.0; t < path.duration(); t += 1 * ms) path.at(t, cursor);
  EXPECT_EQ(allocations, before);
}

TEST(Overrides, ScaleFeedsAndRapidsApart) {
  PathOptions half_feed, half_rapid;
  half_feed.feed_override = half_rapid.rapid_override = 0.5;
  AxisWords to = AxisWords::Zero();
  to[0] = 0.4;
  const JointLimits quick = alike(0.5, 1e3, 1e6);
  Program feed, rapid;
  feed.line(to, 0.1);
  rapid.rapid(to);
  EXPECT_NEAR(feed.plan(half_feed, quick).duration(), 8.0, 0.01);
  EXPECT_NEAR(feed.plan(half_rapid, quick).duration(), 4.0, 0.01);
  EXPECT_NEAR(rapid.plan(half_feed, quick).duration(), 0.8, 0.01);
  EXPECT_NEAR(rapid.plan(half_rapid, quick).duration(), 1.6, 0.01);
}

Program corner(double angle, double leg, double feed) {
  Program program;
  program.line(leg, 0, 0, feed);
  program.line(leg + leg * std::cos(angle), leg * std::sin(angle), 0, feed);
  return program;
}

double distance_to_corner(const Trajectory& path, double leg) {
  double least = 1.0;
  each_sample(path, 100 * us, [&](double, const auto& x) {
    least = std::min(least, std::hypot(x.Q_ref[0] - leg, x.Q_ref[1]));
  });
  return least;
}

TEST(Corner, OfNinetyDegreesIsRoundedByTheTolerance) {
  for (const double tolerance : {1 * um, 10 * um, 100 * um, 1 * mm}) {
    PathOptions options;
    options.tolerance = tolerance;
    // at 1 mm/s rounding is faster than stopping
    const double off = distance_to_corner(corner(90 * deg, 5 * mm, 1 * mm).plan(options), 5 * mm);
    EXPECT_NEAR(off, tolerance, 0.01 * tolerance);  // samples need not meet the closest point
  }
}

TEST(Corner, IsExactWhereAStopIsFasterThanRounding) {
  const Trajectory path = corner(90 * deg, 50 * mm, 0.1).plan();
  EXPECT_EQ(path.chains(), 2U);
  EXPECT_EQ(path.chain(0)->end[0], 50 * mm);
}

TEST(Corner, IsNotSlowerWithMoreTolerance) {
  for (const double angle : {10 * deg, 45 * deg, 90 * deg}) {
    double last = 1e9;
    for (const double tolerance : {0.1 * um, 1 * um, 10 * um, 100 * um, 1 * mm}) {
      PathOptions options;
      options.tolerance = tolerance;
      const double time = corner(angle, 50 * mm, 0.05).plan(options).duration();
      EXPECT_LE(time, last * 1.01) << angle << " " << tolerance;  // the choice is an estimate
      last = time;
    }
  }
}

TEST(Corner, OfG61IsReachedExactlyAndOfG61Dot1AsWell) {
  for (const PathMode mode : {PathMode::exact_path, PathMode::exact_stop}) {
    Program program;
    program.path_mode = mode;
    program.line(0.05, 0, 0, 0.1).line(0.05, 0.05, 0, 0.1);
    const Trajectory path = program.plan();
    ASSERT_EQ(path.chains(), 2U);
    Trajectory::Cursor cursor;
    const auto corner = path.at(path.chain(1)->t, cursor);
    EXPECT_EQ(corner.Q_ref[0], 0.05);
    EXPECT_EQ(corner.Q_ref[1], 0.0);
    EXPECT_TRUE(corner.dQ_ref.isZero(0.0));
  }
}

TEST(Corner, OfATangentIsNoStopForG61ButForG61Dot1) {
  for (const PathMode mode : {PathMode::exact_path, PathMode::exact_stop}) {
    Program program;
    program.path_mode = mode;
    program.line(0.05, 0, 0, 0.05);
    program.arc({0.05, 0.02, 0}, {0.07, 0.02, 0}, 2, 1, 0.05).line(0.07, 0.05, 0, 0.05);
    EXPECT_EQ(program.plan().chains(), mode == PathMode::exact_path ? 1U : 3U);
  }
}

TEST(Reversal, StopsAtItsPoint) {
  Program program;
  program.line(0.02, 0, 0, 0.1).line(0, 0, 0, 0.1);
  const Trajectory path = program.plan();
  ASSERT_EQ(path.chains(), 2U);
  EXPECT_EQ(path.chain(1)->begin[0], 0.02);
  EXPECT_DOUBLE_EQ(path.duration(), 2.0 * path.chain(0)->duration);
}

// A tangent line leads in and out, so that the circle is met at speed.
Program circle(double R, double feed, PathMode mode) {
  Joints start = Joints::Zero();
  start.head<3>() << R, -0.03, 0;
  Program program(start);
  program.path_mode = mode;
  program.line(R, 0, 0, feed).arc({0, 0, 0}, {R, 0, 0}, 2, 1, feed).line(R, 0.03, 0, feed);
  return program;
}

TEST(Circle, KeepsRadiusFeedAndCentripetalAcceleration) {
  constexpr double kRadiusTol = 10 * nm;
  for (const double R : {2 * mm, 10 * mm, 100 * mm}) {
    const double v = 23.2 * mm;
    const Trajectory path = circle(R, v, PathMode::continuous).plan();
    const double margin = 4.0 * std::sqrt(12.0 * 10 * um * R);  // m, where the lines blend in
    each_sample(path, 1 * ms, [&](double, const auto& x) {
      const double along = x.s - 0.03;
      if (along < margin || along > 2 * std::numbers::pi * R - margin) return;
      EXPECT_NEAR(std::hypot(x.Q_ref[0], x.Q_ref[1]), R, kRadiusTol);
      EXPECT_NEAR(x.dQ_ref.norm(), v, 0.001 * v);
      EXPECT_NEAR(x.ddQ_ref.norm(), v * v / R, 0.02 * v * v / R);
    });
  }
}

// Two half circles behave as the whole one: nothing is cut off at their joint, no speed is lost.
// With a joint like any other they missed the circle by 5 um and slowed down.
TEST(Circle, OfTwoArcsIsOneCircle) {
  constexpr double kRadiusTol = 10 * nm;
  const double R = 50 * mm, v = 8 * m_per_min;
  Joints start = Joints::Zero();
  start.head<3>() << R, -0.03, 0;
  Program program(start);
  program.line(R, 0, 0, v).arc({0, 0, 0}, {-R, 0, 0}, 2, 1, v).arc({0, 0, 0}, {R, 0, 0}, 2, 1, v);
  int samples = 0;
  each_sample(program.plan(), 1 * ms, [&](double, const auto& x) {
    if (std::abs(x.s - 0.03 - std::numbers::pi * R) > 10 * mm) return;
    ++samples;
    EXPECT_NEAR(std::hypot(x.Q_ref[0], x.Q_ref[1]), R, kRadiusTol);
    EXPECT_NEAR(x.dQ_ref.norm(), v, 0.001 * v);
  });
  EXPECT_GT(samples, 100);
}

TEST(Circle, OfG61StaysWithinItsToleranceFromEndToEnd) {
  const double R = 10 * mm;
  const Trajectory path = circle(R, 23.2 * mm, PathMode::exact_path).plan();
  each_sample(path, 0.5 * ms, [&](double, const auto& x) {
    if (x.line != 2) return;
    EXPECT_NEAR(std::hypot(x.Q_ref[0], x.Q_ref[1]), R, PathOptions{}.exact_tolerance);
  });
}

TEST(Circle, IsSlowedToItsAccelerationLimit) {
  const double R = 2 * mm;
  JointLimits limits = alike(1.0, 2.0, 1e4);
  const Trajectory path = circle(R, 1.0, PathMode::continuous).plan({}, limits);
  double middle = 0.0;
  each_sample(path, 1 * ms, [&](double, const auto& x) {
    EXPECT_LE(x.ddQ_ref.cwiseAbs().maxCoeff(), 2.0 * (1 + kRounding));
    if (std::abs(x.s - 0.03 - std::numbers::pi * R) < 0.5 * mm) middle = x.dQ_ref.norm();
  });
  EXPECT_LE(middle, std::sqrt(2.0 * R));
  EXPECT_GE(middle, 0.5 * std::sqrt(2.0 * R));  // share of the acceleration and merging of speeds
}

// The imposed curve of paper [G]: 150 um over 62 mm at 1394 mm/min, cut into blocks.
TEST(TinyBlocks, OfASmoothCurveRunAtTheProgrammedFeed) {
  const double v = 1394 * mm_per_min, L = 62 * mm, length = 2 * L;
  PathOptions options;
  options.tolerance = 1 * um;
  for (const double block : {1 * mm, 0.2 * mm, 0.05 * mm}) {
    Program program;
    const int n = static_cast<int>(std::lround(length / block));
    for (int i = 1; i <= n; ++i) {
      const double x = length * i / n;
      program.line(x, 150 * um * std::sin(2 * std::numbers::pi * x / L), 0, v);
    }
    const Trajectory path = program.plan(options, alike(40 * m_per_min, 6.0, 100.0));
    double slowest = 1.0;
    each_sample(path, 1 * ms, [&](double, const auto& x) {
      if (x.s < 2 * mm || x.s > length - 2 * mm) return;
      slowest = std::min(slowest, x.dQ_ref.norm());
      const double y = 150 * um * std::sin(2 * std::numbers::pi * x.Q_ref[0] / L);
      EXPECT_LE(std::abs(x.Q_ref[1] - y), options.tolerance + 0.25 * um);  // chords of 1 mm: 0.2 um
    });
    EXPECT_GE(slowest, 0.9999 * v) << block;
  }
}

// 100 mm in n blocks: once a block is shorter than feed times block time, that is the speed.
TEST(BlockTime, LimitsTheSpeedToOneBlockInEach) {
  const double v = 0.1, a = 2.0, j = 50.0, d = 0.1, T = 3.6 * ms;
  const auto duration = [&](int n, double block_time) {
    Program program;
    for (int i = 1; i <= n; ++i) program.line(d * i / n, 0, 0, v);
    PathOptions options;
    options.block_time = block_time;
    return program.plan(options, alike(1.0, a, j)).duration();
  };
  const auto at_speed = [&](double speed) {
    const double ramp = speed * j > a * a ? speed / a + a / j : 2.0 * std::sqrt(speed / j);
    return d / speed + ramp;
  };
  constexpr double kRelative = 1e-6;   // of the time, as where blocks take none
  for (const int n : {1, 100, 277}) {  // 0.361 mm take 3.61 ms
    EXPECT_NEAR(duration(n, T), at_speed(v), kRelative * at_speed(v)) << n;
  }
  for (const int n : {400, 1000, 2000}) {
    const double slow = at_speed(d / n / T);
    EXPECT_NEAR(duration(n, T), slow, kRelative * slow) << n;
    EXPECT_NEAR(duration(n, 0.0), at_speed(v), kRelative * at_speed(v)) << n;
  }
}

// A law: no block of any kind, rapid or turning, is over sooner.
TEST(BlockTime, PassesInEachBlock) {
  PathOptions options;
  options.block_time = 20 * ms;
  options.tolerance = 1 * um;  // corners are cut by next to nothing
  Program program;
  AxisWords to = AxisWords::Zero();
  for (int i = 1; i <= 40; ++i) {
    to << 1e-3 * i, 3e-4 * std::sin(0.5 * i), 0, 0, 0, 0;
    program.line(to, 1.0);
  }
  for (int i = 1; i <= 10; ++i) {
    to[5] += 0.2 * deg;
    program.line(to, 1.0);
  }
  to[0] += 1e-5;
  program.rapid(to);
  const double x = to[0], y = to[1];
  program.arc({x, y + 1 * mm, 0}, {x + 1 * mm, y + 1 * mm, 0}, 1, 1, 1.0);
  const Trajectory path = program.plan(options);
  std::vector<double> time(program.moves().size());
  constexpr double kStep = 10 * us;
  each_sample(path, kStep, [&](double, const auto& at) { time[at.move] += kStep; });
  constexpr double kRounded = 0.01;  // share by which rounded corners are shorter, and samples
  double least = 1.0;
  for (const double t : time) least = std::min(least, t / options.block_time);
  EXPECT_GE(least, 1.0 - kRounded);
  EXPECT_LT(least, 1.0 + kRounded);  // and it is the limit
}

}  // namespace
}  // namespace servomill::controllers::test::known_paths_test
