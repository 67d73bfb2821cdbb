#include "sim/metrology/cylinder_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/metrology/sphere_fit.h"
#include "tests/sim/metrology/random_poses.h"

namespace servomill::sim::metrology::cylinder_fit_test {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kR = 55.0 * mm;
constexpr double kRounding = 1e-15;        // m, of some operations on lengths of 0.5 m
constexpr double kTolerance = 1e-13;       // m, of conditions up to 100 in well spread points
constexpr double kPoorTolerance = 1e-10;   // m, in arcs of 30 deg
constexpr double kAngleTolerance = 1e-12;  // rad

// Points of a cylinder of length h about Z, first around and then along; radius kR + by(theta, z)
std::vector<Vector3d> cylinder_points(const Eigen::Isometry3d& pose, double h, double arc,
                                      int around, int along,
                                      const std::function<double(double, double)>& by) {
  std::vector<Vector3d> points;
  for (int k = 0; k < along; ++k) {
    for (int i = 0; i < around; ++i) {
      const double theta = arc * i / around, z = h * (k / (along - 1.0) - 0.5);
      const double r = kR + by(theta, z);
      points.push_back(pose * Vector3d(r * std::cos(theta), r * std::sin(theta), z));
    }
  }
  return points;
}

double nothing(double, double) { return 0.0; }

// Distance of two axes at the ends of a length around the pose's origin.
double axis_error(const Cylinder& cylinder, const Eigen::Isometry3d& pose, double h) {
  double error = 0.0;
  for (const double z : {-0.5 * h, 0.5 * h}) {
    const Vector3d p = pose * Vector3d(0.0, 0.0, z);
    error = std::max(error, cylinder.direction.cross(p - cylinder.point).norm());
  }
  return error;
}

TEST(LeastSquaresCylinder, ReturnsTheCylinderThatPointsLieOnInAnyPose) {
  Random random(1);
  for (int n = 0; n < 60; ++n) {
    const Eigen::Isometry3d pose = random.pose(0.5);
    const double h = std::pow(10.0, random.within(-2.5, -0.3));  // 3 to 500 mm
    const auto points = cylinder_points(pose, h, kTurn, 12 + n, 2 + n % 5, nothing);
    const auto cylinder = least_squares_cylinder(points);
    ASSERT_TRUE(cylinder) << n;
    EXPECT_NEAR(cylinder->radius, kR, kTolerance) << n;
    EXPECT_LT(axis_error(*cylinder, pose, h), kTolerance) << n;
    EXPECT_LT(spread_about(points, *cylinder).range(), kTolerance) << n;
  }
}

TEST(LeastSquaresCylinder, ReturnsTheCylinderOfAnArcOf30Degrees) {
  Random random(2);
  for (int n = 0; n < 30; ++n) {
    const Eigen::Isometry3d pose = random.pose(0.1);
    const double h = random.within(10.0, 100.0) * mm;
    const auto points = cylinder_points(pose, h, 30.0 * deg, 20, 7, nothing);
    const auto cylinder = least_squares_cylinder(points, pose.linear().col(2));
    ASSERT_TRUE(cylinder) << n;
    EXPECT_NEAR(cylinder->radius, kR, kPoorTolerance) << n;
    EXPECT_LT(axis_error(*cylinder, pose, h), kPoorTolerance) << n;
    EXPECT_GT(cylinder->direction.dot(pose.linear().col(2)), 0.0);
  }
}

// Two and more lobes around, in antisymmetric heights (barrel, waist), have no share of shift,
// slope and radius, so that the axis stays; the mean radius stays but for second order terms of the
// slopes.
TEST(LeastSquaresCylinder, SeesNoMotionInLobes) {
  constexpr double kSecondOrder = 1e-12;  // m: (10 um)^2 / 55 mm * 1e-4: of the distances
  Random random(3);
  const Eigen::Isometry3d pose = random.pose(0.1);
  const auto points = cylinder_points(pose, 60.0 * mm, kTurn, 90, 7, [](double theta, double z) {
    return 5.0 * um * std::cos(3.0 * theta + 1.0) +
           4.0 * um * std::cos(2.0 * theta) * z / (30.0 * mm);
  });
  const auto cylinder = least_squares_cylinder(points);
  ASSERT_TRUE(cylinder);
  EXPECT_NEAR(cylinder->radius, kR, kSecondOrder);
  EXPECT_LT(axis_error(*cylinder, pose, 60.0 * mm), kSecondOrder);
}

// The sum of squares along every motion by central differences, in units of its own rounding.
TEST(LeastSquaresCylinder, LeavesNoSlopeOfTheSum) {
  Random random(4);
  for (const double spread : {1.0 * um, 0.1 * mm, 3.0 * mm}) {
    const auto points =
        cylinder_points(random.pose(0.1), 60.0 * mm, 0.7 * kTurn, 40, 5,
                        [&](double, double) { return random.within(-spread, spread); });
    const auto cylinder = least_squares_cylinder(points);
    ASSERT_TRUE(cylinder);
    const Vector3d u = across(cylinder->direction), v = cylinder->direction.cross(u);
    // d(distance): shift along u, v; turn towards u, v; radius
    Eigen::Vector<double, 5> gradient = Eigen::Vector<double, 5>::Zero(), size = gradient;
    for (const Vector3d& p : points) {
      const Vector3d q = p - cylinder->point;
      const Vector3d radial = q - cylinder->direction.dot(q) * cylinder->direction;
      const Vector3d out = radial.normalized();
      const double z = cylinder->direction.dot(q);
      Eigen::Vector<double, 5> term;
      term << u.dot(out), v.dot(out), z * u.dot(out), z * v.dot(out), 1.0;
      term *= cylinder->distance(p);
      gradient += term;
      size += term.cwiseAbs();
    }
    const double rounding = 1e-12 + 1e-16 / spread;  // distances are good to 1e-16 m
    EXPECT_LT((gradient.array() / size.array()).abs().maxCoeff(), rounding) << spread;
  }
}

TEST(LeastSquaresCylinder, IsNotDeterminedByASectionALineOrAPlane) {
  const Eigen::Isometry3d pose = Random(5).pose(0.1);
  EXPECT_FALSE(least_squares_cylinder(std::vector<Vector3d>{}));
  auto points = cylinder_points(pose, 0.0, kTurn, 36, 2, nothing);
  EXPECT_FALSE(least_squares_cylinder(points)) << "one section";
  EXPECT_FALSE(least_squares_cylinder(points, pose.linear().col(2))) << "one section";
  points = cylinder_points(pose, 0.1, 0.0, 10, 10, nothing);
  EXPECT_FALSE(least_squares_cylinder(points)) << "a line";
}

TEST(LeastSquaresSphere, ReturnsTheSphereThatPointsLieOn) {
  Random random(6);
  for (int n = 0; n < 100; ++n) {
    const Vector3d centre = random.in_cube(0.5);
    std::vector<Vector3d> points;
    for (int i = 0; i < 10 + n; ++i) points.push_back(centre + kR * random.direction());
    const auto sphere = least_squares_sphere(points);
    ASSERT_TRUE(sphere);
    EXPECT_NEAR((sphere->centre - centre).norm(), 0.0, kTolerance) << n;
    EXPECT_NEAR(sphere->radius, kR, kTolerance) << n;
    EXPECT_LT(spread_about(points, *sphere).range(), kTolerance) << n;
  }
}

TEST(LeastSquaresSphere, LeavesDeviationsWithoutMeanAndFirstHarmonic) {
  Random random(7);
  std::vector<Vector3d> points;
  for (int i = 0; i < 300; ++i) {
    Vector3d d = random.direction();
    d.z() = std::abs(d.z());  // a half-sphere
    points.push_back((kR + random.within(-1.0, 1.0) * mm) * d);
  }
  const auto sphere = least_squares_sphere(points);
  ASSERT_TRUE(sphere);
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  for (const Vector3d& p : points) {
    Eigen::Vector4d row;
    row << (p - sphere->centre).normalized(), 1.0;
    gradient += sphere->distance(p) * row;
  }
  EXPECT_LT(gradient.cwiseAbs().maxCoeff(), 300 * kRounding);
}

TEST(LeastSquaresSphere, IsNotDeterminedByACircle) {
  EXPECT_FALSE(least_squares_sphere(
      cylinder_points(Eigen::Isometry3d::Identity(), 0.0, kTurn, 36, 2, nothing)));
}

TEST(LeastSquaresCircleOfSpace, ReturnsTheCircleThatPointsLieOn) {
  Random random(8);
  for (int n = 0; n < 50; ++n) {
    const Eigen::Isometry3d pose = random.pose(0.5);
    const auto points = cylinder_points(pose, 0.0, n % 2 ? kTurn : 0.3 * kTurn, 5 + n, 2, nothing);
    const auto circle = least_squares_circle(points, pose.linear().col(2));
    ASSERT_TRUE(circle);
    EXPECT_LT((circle->centre - pose.translation()).norm(), kTolerance) << n;
    EXPECT_LT((circle->normal - pose.linear().col(2)).norm(), kAngleTolerance) << n;
    EXPECT_NEAR(circle->radius, kR, kTolerance) << n;
    EXPECT_LT(spread_about(points, *circle).range(), kTolerance) << n;
  }
}

TEST(LeastSquaresCircleOfSpace, IsNotDeterminedByALine) {
  EXPECT_FALSE(least_squares_circle(std::vector<Vector3d>{{0, 0, 0}, {1, 1, 1}, {3, 3, 3}},
                                    Vector3d::UnitZ()));
}

}  // namespace
}  // namespace servomill::sim::metrology::cylinder_fit_test
