#include "plant/vocabulary/spline_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "plant/vocabulary/move_curve.h"
#include "tests/plant/vocabulary/cox_de_boor.h"

namespace servomill::spline_curve_test {
namespace {

using Eigen::Vector3d;

constexpr double kRoundingTol = 1e-15;  // m, a few operations at 0.1 m
constexpr double kLengthTol = 1e-12;    // m, of the arc length
constexpr double kPi = std::numbers::pi;

struct Programmed {
  int order = 3;
  std::vector<Vector3d> points;
  std::vector<double> weights;
};

SplineCurve curve_of(const Programmed& p) { return {p.order, p.points, p.weights}; }
CoxDeBoor reference_of(const Programmed& p) { return {p.order, p.points, p.weights}; }

Programmed random_curve(std::mt19937& random) {
  std::uniform_real_distribution<double> place(-0.05, 0.05), weight(0.2, 5.0);
  Programmed out;
  out.order = 3 + static_cast<int>(random() % 3);
  const std::size_t count = static_cast<std::size_t>(out.order) + random() % 6;
  for (std::size_t i = 0; i < count; ++i) {
    out.points.emplace_back(place(random), place(random), 0.01);
    out.weights.push_back(weight(random));
  }
  return out;
}

Programmed quarter_circle(double radius) {
  return {3,
          {{radius, 0.0, 0.0}, {radius, radius, 0.0}, {0.0, radius, 0.0}},
          {1.0, std::sqrt(0.5), 1.0}};
}

TEST(SplineCurve, LiesOnTheCurveOfItsDefinition) {
  std::mt19937 random(1);
  for (int n = 0; n < 40; ++n) {
    const Programmed one = random_curve(random);
    const SplineCurve curve = curve_of(one);
    const CoxDeBoor reference = reference_of(one);
    for (const double share : {0.0, 0.1, 0.25, 0.5, 0.77, 1.0}) {
      constexpr double kFoundTol = 1e-10;  // m, of the search for the closest point
      EXPECT_LT(reference.distance(curve.point(share * curve.length()), 2000), kFoundTol) << n;
    }
    EXPECT_EQ(curve.point(0.0), one.points.front());
    EXPECT_EQ(curve.point(curve.length()), one.points.back());
  }
}

TEST(SplineCurve, LengthIsThatOfManyChords) {
  std::mt19937 random(2);
  for (int n = 0; n < 10; ++n) {
    const Programmed one = random_curve(random);
    const CoxDeBoor reference = reference_of(one);
    // chords miss the length by h^2; two numbers of chords give it without
    const double few = reference.length(20000), many = reference.length(40000);
    EXPECT_NEAR(curve_of(one).length(), many + (many - few) / 3.0, 1e-11) << n;
  }
}

TEST(SplineCurve, QuarterCircleGoesByItsAngle) {
  constexpr double kRadius = 0.05;
  const SplineCurve arc = curve_of(quarter_circle(kRadius));
  EXPECT_NEAR(arc.length(), 0.5 * kPi * kRadius, kLengthTol);
  for (const double share : {0.1, 0.3, 0.5, 0.9}) {
    const double angle = 0.5 * kPi * share;
    const SplineCurve::State at = arc.state(share * arc.length());
    EXPECT_LT((at.p - kRadius * Vector3d(std::cos(angle), std::sin(angle), 0.0)).norm(),
              kLengthTol);
    EXPECT_LT((at.tangent - Vector3d(-std::sin(angle), std::cos(angle), 0.0)).norm(), 1e-10);
    EXPECT_LT((at.curvature * kRadius + at.p / kRadius).norm(), 1e-10);
  }
}

TEST(SplineCurve, TangentAndCurvatureAreDerivatives) {
  std::mt19937 random(3);
  constexpr double kStep = 1e-6;  // m
  for (int n = 0; n < 20; ++n) {
    const SplineCurve curve = curve_of(random_curve(random));
    const double s = 0.37 * curve.length();
    const SplineCurve::State at = curve.state(s);
    const Vector3d d1 = (curve.point(s + kStep) - curve.point(s - kStep)) / (2.0 * kStep);
    const Vector3d d2 =
        (curve.state(s + kStep).tangent - curve.state(s - kStep).tangent) / (2.0 * kStep);
    EXPECT_LT((at.tangent - d1).norm(), 1e-5) << n;
    EXPECT_LT((at.curvature - d2).norm(), 1e-4 * (1.0 + d2.norm())) << n;
    EXPECT_NEAR(at.tangent.norm(), 1.0, 1e-14) << n;
  }
}

TEST(SplineCurve, FindsItsOwnPointsAsClosest) {
  std::mt19937 random(4);
  for (int n = 0; n < 20; ++n) {
    const SplineCurve curve = curve_of(random_curve(random));
    for (const double share : {0.02, 0.2, 0.5, 0.81}) {
      const double s = share * curve.length();
      EXPECT_LT((curve.point(curve.closest(curve.point(s))) - curve.point(s)).norm(), 1e-9) << n;
    }
  }
  // a loop: the other branch is near where it crosses itself
  const SplineCurve loop =
      curve_of({4,
                {{0.0, 0.0, 0.0}, {0.06, 0.04, 0.0}, {-0.02, 0.04, 0.0}, {0.04, 0.0, 0.0}},
                {1, 1, 1, 1}});
  for (int i = 0; i <= 400; ++i) {
    const Vector3d p = loop.point(loop.length() * i / 400);
    EXPECT_LT((loop.point(loop.closest(p)) - p).norm(), 1e-9) << i;
  }
  // its derivative is 0 at both ends
  const SplineCurve halting = curve_of(
      {4,
       {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.01, 0.0, 0.0}, {0.02, 0.01, 0.0}, {0.02, 0.01, 0.0}},
       {1.0, 1.7, 0.6, 2.3, 0.8}});
  for (const double s : {1e-5, halting.length() - 1e-5}) {
    EXPECT_NEAR(halting.closest(halting.point(s)), s, 1e-9);
  }
  const SplineCurve arc = curve_of(quarter_circle(0.05));
  EXPECT_NEAR(arc.closest({0.07, 0.07, 0.03}), 0.5 * arc.length(), kLengthTol);
  EXPECT_EQ(arc.closest({0.06, -0.01, 0.0}), 0.0);
  EXPECT_EQ(arc.closest({-0.01, 0.06, 0.0}), arc.length());
}

TEST(SplineCurve, ExtentReachesTheFarthestPoints) {
  std::mt19937 random(5);
  for (int n = 0; n < 20; ++n) {
    const SplineCurve curve = curve_of(random_curve(random));
    const auto [low, high] = curve.extent();
    Vector3d seen_low = curve.point(0.0), seen_high = seen_low;
    for (int i = 0; i <= 3000; ++i) {
      const Vector3d p = curve.point(curve.length() * i / 3000);
      seen_low = seen_low.cwiseMin(p);
      seen_high = seen_high.cwiseMax(p);
    }
    EXPECT_TRUE((low.array() <= seen_low.array() + kRoundingTol).all()) << n;
    EXPECT_TRUE((high.array() >= seen_high.array() - kRoundingTol).all()) << n;
    constexpr double kBetweenTol = 1e-4;  // m, what points of the curve may miss
    EXPECT_LT((seen_low - low).norm() + (high - seen_high).norm(), kBetweenTol) << n;
  }
  const SplineCurve arch = curve_of(
      {4, {{0.0, 0.0, 0.0}, {0.0, 0.1, 0.0}, {0.1, 0.1, 0.0}, {0.1, 0.0, 0.0}}, {1, 1, 1, 1}});
  EXPECT_NEAR(arch.extent().second.y(), 0.075, kRoundingTol);
}

TEST(SplineCurve, BreaksAreWherePointsCoincideAndAtCusps) {
  EXPECT_TRUE(curve_of(quarter_circle(0.05)).breaks().empty());
  // a quadratic that passes through a double point
  const SplineCurve bent = curve_of({3,
                                     {{0.0, 0.0, 0.0},
                                      {0.01, 0.0, 0.0},
                                      {0.02, 0.0, 0.0},
                                      {0.02, 0.0, 0.0},
                                      {0.02, 0.01, 0.0},
                                      {0.02, 0.02, 0.0}},
                                     std::vector<double>(6, 1.0)});
  ASSERT_EQ(bent.breaks().size(), 1U);
  EXPECT_LT((bent.point(bent.breaks()[0]) - Vector3d(0.02, 0.0, 0.0)).norm(), 1e-9);
  // control polygon crossed like an X: a cusp halfway
  const SplineCurve cusp = curve_of(
      {4, {{0.0, 0.0, 0.0}, {0.01, 0.01, 0.0}, {0.0, 0.01, 0.0}, {0.01, 0.0, 0.0}}, {1, 1, 1, 1}});
  ASSERT_EQ(cusp.breaks().size(), 1U);
  EXPECT_NEAR(cusp.breaks()[0], 0.5 * cusp.length(), 1e-9);
  // the same curve; weights in a geometric row only change how it is run through
  const SplineCurve shorn =
      curve_of({4,
                {{0.0, 0.0, 0.0}, {0.01, 0.01, 0.0}, {0.0, 0.01, 0.0}, {0.01, 0.0, 0.0}},
                {1.0, 2.0, 4.0, 8.0}});
  EXPECT_EQ(shorn.breaks().size(), 1U);
}

TEST(SplineCurve, BeginsWithADirectionAlsoWhereItStandsStill) {
  // G5 without I and J: the first two points coincide
  const SplineCurve curve = curve_of(
      {4, {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.01, 0.0}, {0.01, 0.01, 0.0}}, {1, 1, 1, 1}});
  EXPECT_LT((curve.state(0.0).tangent - Vector3d::UnitY()).norm(), 1e-4);
  EXPECT_TRUE(curve.breaks().empty());
  const CoxDeBoor reference(
      4, {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.01, 0.0}, {0.01, 0.01, 0.0}}, {1, 1, 1, 1});
  EXPECT_LT(reference.distance(curve.point(1e-6), 5000), 1e-10);
}

TEST(SplineCurve, APointWithoutLengthIsOne) {
  const Vector3d here(0.01, 0.02, 0.0);
  const SplineCurve curve = curve_of({3, {here, here, here}, {1, 1, 1}});
  EXPECT_EQ(curve.length(), 0.0);
  EXPECT_EQ(curve.point(0.0), here);
  EXPECT_EQ(curve.closest({1.0, 0.0, 0.0}), 0.0);
  EXPECT_TRUE(curve.breaks().empty());
}

TEST(MoveCurve, SplineGoesByItsLength) {
  const Programmed arc = quarter_circle(0.05);
  Move move;
  move.kind = MoveKind::spline;
  move.spline = std::make_shared<const Spline>(Spline{curve_of(arc), arc.points});
  AxisWords from = AxisWords::Zero();
  from.head<3>() = arc.points.front();
  move.end_machine.head<3>() = arc.points.back();
  const MoveCurve curve(from, move);
  EXPECT_NEAR(curve.length(), 0.025 * kPi, kLengthTol);
  EXPECT_NEAR(curve.at(0.5)[0], 0.05 * std::sqrt(0.5), kLengthTol);
  EXPECT_NEAR(curve.closest({0.01, 0.01, 0.0}), 0.5, 1e-9);
  EXPECT_EQ(curve.at(1.0), move.end_machine);
}

}  // namespace
}  // namespace servomill::spline_curve_test
