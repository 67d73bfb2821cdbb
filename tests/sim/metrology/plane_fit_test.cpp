#include "sim/metrology/plane_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/metrology/line_fit.h"
#include "tests/sim/metrology/random_poses.h"

namespace servomill::sim::metrology::plane_fit_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRounding = 1e-15;       // m, of some operations on lengths of 0.5 m
constexpr double kAngleRounding = 1e-14;  // rad, of kRounding over 0.1 m
// Share of the sum of the products' absolute values below which a gradient is zero but for
// rounding.
constexpr double kZero = 1e-12;

TEST(LeastSquaresPlane, ReturnsThePlaneThatPointsLieOn) {
  Random random(1);
  for (int n = 0; n < 200; ++n) {
    const Eigen::Isometry3d pose = random.pose(0.5);
    std::vector<Vector3d> points;
    for (int i = 0; i < 3 + n; ++i) {
      points.push_back(pose * Vector3d(random.within(-0.1, 0.1), random.within(-0.05, 0.05), 0.0));
    }
    const Vector3d normal = pose.linear().col(2);
    const auto plane = least_squares_plane(points, normal);
    ASSERT_TRUE(plane) << n;
    EXPECT_LT(spread_about(points, *plane).range(), 10 * kRounding) << n;
    // three random points may lie close to a line
    if (n > 20) {
      EXPECT_LT(rotation_between(normal, plane->normal).norm(), kAngleRounding) << n;
    }
    const auto turned = least_squares_plane(points, -normal);
    EXPECT_EQ(turned->normal, -plane->normal);
  }
}

// A saddle z = h xy / ab over a grid of +-a, +-b has the same weight on every side: the plane stays
// where it is, and the flatness about it is 2 h.
TEST(LeastSquaresPlane, SeesTheHeightOfASaddle) {
  Random random(2);
  const double h = 7.0 * um;
  const Eigen::Isometry3d pose = random.pose(0.3);
  std::vector<Vector3d> points;
  for (int i = -5; i <= 5; ++i) {
    for (int k = -4; k <= 4; ++k) {
      points.push_back(pose * Vector3d(0.1 * i / 5.0, 0.03 * k / 4.0, h * i / 5.0 * k / 4.0));
    }
  }
  const auto plane = least_squares_plane(points, pose.linear().col(2));
  ASSERT_TRUE(plane);
  EXPECT_NEAR(spread_about(points, *plane).range(), 2.0 * h, 10 * kRounding);
  EXPECT_LT(rotation_between(pose.linear().col(2), plane->normal).norm(), kAngleRounding);
  EXPECT_NEAR((plane->point - pose.translation()).norm(), 0.0, kRounding);
}

// Moving along the normal and turning about u and v leave the sum: sum d = 0, sum d u = sum d v =
// 0.
TEST(LeastSquaresPlane, LeavesDeviationsWithoutMeanAndSlope) {
  Random random(3);
  for (const double spread : {1.0 * um, 1.0 * mm, 20.0 * mm}) {
    std::vector<Vector3d> points;
    const Eigen::Isometry3d pose = random.pose(0.3);
    for (int i = 0; i < 200; ++i) {
      points.push_back(pose * Vector3d(random.within(-0.1, 0.1), random.within(-0.05, 0.05),
                                       random.within(-spread, spread)));
    }
    const auto plane = least_squares_plane(points, Vector3d::UnitZ());
    ASSERT_TRUE(plane);
    const Vector3d u = across(plane->normal), v = plane->normal.cross(u);
    Vector3d gradient = Vector3d::Zero(), size = Vector3d::Zero();
    for (const Vector3d& p : points) {
      const Vector3d q = p - plane->point;
      const Vector3d term = plane->distance(p) * Vector3d(0.1, u.dot(q), v.dot(q));
      gradient += term;
      size += term.cwiseAbs();
    }
    // the distances are differences of coordinates of 0.5 m
    const double rounding = kZero + 1e-16 / spread;
    EXPECT_LT((gradient.array() / size.array()).abs().maxCoeff(), rounding) << spread;
  }
}

TEST(LeastSquaresPlane, IsNotDeterminedByPointsOfALine) {
  std::vector<Vector3d> points;
  EXPECT_FALSE(least_squares_plane(points, Vector3d::UnitZ()));
  for (int i = 0; i < 10; ++i)
    points.push_back(Vector3d(0.1, 0.2, 0.3) + 0.01 * i * Vector3d(3, 2, 1));
  EXPECT_FALSE(least_squares_plane(points, Vector3d::UnitZ()));
  points.push_back(Vector3d(0.1, 0.2, 0.4));
  EXPECT_TRUE(least_squares_plane(points, Vector3d::UnitZ()));
}

TEST(RotationBetween, IsTheSlopeOfAPlane) {
  const double a = 30.0 * urad, b = -20.0 * urad;
  const Vector3d turn = rotation_between(Vector3d::UnitZ(), Vector3d(-a, -b, 1.0).normalized());
  constexpr double kThirdOrder = 1e-13;  // rad
  EXPECT_LT((turn - Vector3d(b, -a, 0.0)).norm(), kThirdOrder);
}

TEST(RotationBetween, TurnsOneIntoTheOther) {
  Random random(4);
  for (int n = 0; n < 100; ++n) {
    const Vector3d from = random.direction(), to = random.direction();
    const Vector3d turn = rotation_between(from, to);
    const Vector3d turned = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * from;
    EXPECT_LT((turned - to).norm(), kAngleRounding);
  }
}

TEST(LeastSquaresLine, ReturnsTheLineThatPointsLieOnFromFirstToLast) {
  Random random(5);
  for (int n = 0; n < 100; ++n) {
    const Vector3d a = random.in_cube(0.5), w = random.direction();
    const Vector2d w2 = w.head<2>().normalized();
    std::vector<Vector3d> points;
    std::vector<Vector2d> flat;
    for (int i = 0; i < 2 + n; ++i) {
      const double s = 0.2 * i / (1 + n) + random.within(0.0, 0.01);
      points.push_back(a + s * w);
      flat.push_back(a.head<2>() + s * w2);
    }
    const auto line = least_squares_line(points);
    const auto line2 = least_squares_line(flat);
    ASSERT_TRUE(line && line2);
    EXPECT_LT((line->direction - w).norm(), kAngleRounding);
    EXPECT_LT(line->distance(a), 10 * kRounding);
    EXPECT_LT(spread_about(points, *line).high, 10 * kRounding);
    EXPECT_LT((line2->direction - w2).norm(), kAngleRounding);
    EXPECT_LT(spread_about(flat, *line2).range(), 10 * kRounding);
  }
}

// Three points 0, h, 0: the line lies h / 3 above the ends, whatever the way it runs.
TEST(LeastSquaresLine, IsSignedToTheLeft) {
  const double h = 6.0 * um;
  const std::vector<Vector2d> points = {{0.0, 0.0}, {0.05, h}, {0.1, 0.0}};
  const Spread spread = spread_about(points, *least_squares_line(points));
  EXPECT_NEAR(spread.low, -h / 3.0, kRounding);
  EXPECT_NEAR(spread.high, 2.0 * h / 3.0, kRounding);
}

TEST(LeastSquaresLine, IsNotDeterminedByOnePlace) {
  const std::vector<Vector2d> points(5, Vector2d(0.3, 0.1));
  EXPECT_FALSE(least_squares_line(points));
  EXPECT_FALSE(least_squares_line(std::vector<Vector3d>(1, Vector3d(1.0, 2.0, 3.0))));
}

}  // namespace
}  // namespace servomill::sim::metrology::plane_fit_test
