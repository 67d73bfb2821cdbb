/// The time law that uses the jerk of every joint.
#include "controllers/path/time_optimal_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::time_optimal_law_test {
namespace {

constexpr double kRounding = 1e-7;  // of a limit

// One period of a wave of Y over X: q''' is largest where it crosses the X axis.
SmoothPath wave(double length, double height, int count) {
  std::vector<PathVertex> v;
  for (int i = 0; i <= count; ++i) {
    const double x = length * i / count;
    PathVertex vertex;
    vertex.u[0] = x;
    vertex.u[1] = height * std::sin(2.0 * std::numbers::pi * x / length);
    vertex.tolerance_linear = vertex.tolerance_rotary = 10 * um;
    vertex.speed = 0.1;
    v.push_back(vertex);
  }
  return smooth(v, Joints::Constant(50.0));
}

JointLimits limits() {
  return {Joints::Constant(0.5), Joints::Constant(3.0), Joints::Constant(50.0)};
}

// Rest to rest at a speed that is safe everywhere.
TimeLaw slow_law(const SmoothPath& path) {
  return plan_speed(std::vector<SegmentLimits>{{path.length(), 20 * mm, 0.5, 10.0}});
}

TEST(Phase, SolvesItsEquation) {
  for (const double beta : {-900.0, -20.0, 20.0, 900.0}) {
    const Phase p{1.0, 0.1, 0.03, 0.2, 0.0, beta};
    const double h = 1e-4;
    for (double t = 1.0 + h; t < 1.1; t += 0.01) {
      const auto a = p.at(t - h), b = p.at(t), c = p.at(t + h);
      EXPECT_NEAR((c.s - a.s) / (2 * h), b.v, 1e-6);
      EXPECT_NEAR((c.v - a.v) / (2 * h), b.a, 1e-4);
      EXPECT_NEAR(b.a, p.a + beta * (b.s - p.s), 1e-12);
      EXPECT_NEAR(b.j, beta * b.v, 1e-12);
    }
  }
}

// Series near zero, closed form beyond: both at the change.
TEST(Phase, HasNoStepWhereItsFormulaChanges) {
  for (const double sign : {-1.0, 1.0}) {
    const double x = 0.01;
    const auto at = [&](double y) {
      return Phase{0.0, 0.0, 0.03, 0.2, 0.0, sign * y / (x * x)}.at(x);
    };
    EXPECT_NEAR(at(0.1 - 1e-12).s, at(0.1 + 1e-12).s, 1e-15);
    EXPECT_NEAR(at(0.1 - 1e-12).v, at(0.1 + 1e-12).v, 1e-13);
  }
}

TEST(TimeOptimalLaw, KeepsTheLimitsAndIsQuicker) {
  const SmoothPath path = wave(20 * mm, 2 * mm, 400);
  const std::vector<double> v_top(path.pieces.size(), 100 * mm);
  const TimeLaw slow = slow_law(path), law = refine_time_law(slow, path, v_top, limits());
  EXPECT_LT(law.duration, 0.99 * slow.duration);
  double used = 0.0;
  std::size_t phase = 0, piece = 0;
  for (int n = 0; n < 20000; ++n) {
    const double t = law.duration * n / 20000.0;
    while (phase + 1 < law.phases.size() && law.phases[phase + 1].t <= t) ++phase;
    const auto x = law.phases[phase].at(t);
    while (piece + 1 < path.pieces.size() && path.pieces[piece + 1].s <= x.s) ++piece;
    const CubicPiece& q = path.pieces[piece];
    const double y = x.s - q.s;
    const Joints d1 = q.c1 + y * (q.c2 + q.c3 * (y / 2.0)), d2 = q.c2 + q.c3 * y;
    const Joints a = d2 * (x.v * x.v) + d1 * x.a;
    const Joints j = q.c3 * (x.v * x.v * x.v) + d2 * (3.0 * x.v * x.a) + d1 * x.j;
    ASSERT_LE(x.v, v_top[piece] * (1 + kRounding));
    ASSERT_LE(a.cwiseAbs().maxCoeff(), 3.0 * (1 + kRounding));
    ASSERT_LE(j.cwiseAbs().maxCoeff(), 50.0 * (1 + kRounding));
    used = std::max(used, j.cwiseAbs().maxCoeff() / 50.0);
  }
  EXPECT_GE(used, 0.9);
}

TEST(TimeOptimalLaw, EveryPhaseEndsWhereTheNextBegins) {
  const SmoothPath path = wave(20 * mm, 2 * mm, 400);
  const std::vector<double> v_top(path.pieces.size(), 100 * mm);
  const TimeLaw law = refine_time_law(slow_law(path), path, v_top, limits());
  for (std::size_t i = 0; i + 1 < law.phases.size(); ++i) {
    const auto end = law.phases[i].at(law.phases[i + 1].t);
    ASSERT_NEAR(end.s, law.phases[i + 1].s, 1e-14) << i;
    ASSERT_NEAR(end.v, law.phases[i + 1].v, 1e-12) << i;
    ASSERT_NEAR(end.a, law.phases[i + 1].a, 1e-9) << i;
  }
}

TEST(TimeOptimalLaw, LeavesALawThatCannotBeImproved) {
  SmoothPath line;
  CubicPiece piece;
  piece.c0 = piece.c2 = piece.c3 = Joints::Zero();
  piece.c1 = Joints::Unit(0);
  line.pieces = {piece};
  line.s = {0.0, 0.1};
  const TimeLaw law = plan_speed(std::vector<SegmentLimits>{{0.1, 50 * mm, 3.0, 50.0}});
  EXPECT_EQ(refine_time_law(law, line, std::vector<double>{50 * mm}, limits()).duration,
            law.duration);
}

}  // namespace
}  // namespace servomill::controllers::time_optimal_law_test
