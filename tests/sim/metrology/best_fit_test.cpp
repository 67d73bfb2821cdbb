#include "sim/metrology/best_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/metrology/triangle_mesh.h"
#include "tests/sim/metrology/random_poses.h"

namespace servomill::sim::metrology::best_fit_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kRounding = 1e-15;   // m, of some operations on lengths of 0.2 m
constexpr double kMotionTol = 1e-12;  // m and rad: the issue asks for 1 nm

TriangleMesh m1_part() {
  std::ifstream file(SERVOMILL_SOURCE_DIR "/scenarios/guevel2025/m1_part.stl", std::ios::binary);
  return TriangleMesh::parse(std::string(std::istreambuf_iterator<char>(file), {}), "m1_part.stl");
}

// Evenly over the faces: a part of them falls on each triangle in proportion to its area.
std::vector<Vector3d> points_on(const TriangleMesh& mesh, int count, Random& random) {
  const Triangles& t = mesh.triangles();
  std::vector<double> area;
  double total = 0.0;
  for (const auto& c : t.triangles) {
    total +=
        0.5 * (t.corners[c[1]] - t.corners[c[0]]).cross(t.corners[c[2]] - t.corners[c[0]]).norm();
    area.push_back(total);
  }
  std::vector<Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double at = random.within(0.0, total);
    const auto& c = t.triangles[std::lower_bound(area.begin(), area.end(), at) - area.begin()];
    double u = random.within(0, 1), v = random.within(0, 1);
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    const Vector3d& A = t.corners[c[0]];
    points.push_back(A + u * (t.corners[c[1]] - A) + v * (t.corners[c[2]] - A));
  }
  return points;
}

Isometry3d small_motion(double shift, double angle, Random& random) {
  return Eigen::Translation3d(shift * random.direction()) *
         Eigen::AngleAxisd(angle, random.direction());
}

std::vector<Vector3d> moved(const std::vector<Vector3d>& points, const Isometry3d& motion) {
  std::vector<Vector3d> out;
  for (const Vector3d& p : points) out.push_back(motion * p);
  return out;
}

double difference(const Isometry3d& a, const Isometry3d& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

TEST(BestFitOfPairs, ReturnsAnyMotion) {
  Random random(1);
  for (int n = 0; n < 200; ++n) {
    std::vector<Vector3d> points;
    for (int i = 0; i < 3 + n % 20; ++i) points.push_back(random.in_cube(0.1));
    const Isometry3d motion = random.pose(0.5);
    const auto fit = best_fit(points, moved(points, motion));
    ASSERT_TRUE(std::holds_alternative<BestFit>(fit));
    EXPECT_LT(difference(std::get<BestFit>(fit).motion, motion), kMotionTol);
    EXPECT_NEAR(std::get<BestFit>(fit).motion.linear().determinant(), 1.0, 10 * kRounding);
    EXPECT_LT(std::get<BestFit>(fit).rms, kMotionTol);
  }
}

TEST(BestFitOfPairs, MakesTheSumSmallest) {
  Random random(2);
  std::vector<Vector3d> points, partners;
  for (int i = 0; i < 50; ++i) {
    points.push_back(random.in_cube(0.1));
    partners.push_back(points.back() + random.in_cube(0.01));
  }
  const auto fit = std::get<BestFit>(best_fit(points, partners));
  const auto sum = [&](const Isometry3d& motion) {
    double out = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      out += (motion * points[i] - partners[i]).squaredNorm();
    }
    return out;
  };
  for (int n = 0; n < 100; ++n) {
    EXPECT_GT(sum(small_motion(1e-6, 1e-5, random) * fit.motion), sum(fit.motion));
  }
  EXPECT_NEAR(fit.rms, std::sqrt(sum(fit.motion) / 50.0), kRounding);
}

TEST(BestFitOfPairs, SaysWhatALineLeavesFree) {
  const std::vector<Vector3d> line = {{0, 0, 0}, {0.1, 0, 0}, {0.2, 0, 0}};
  const auto fit = best_fit(line, line);
  ASSERT_TRUE(std::holds_alternative<NoFit>(fit));
  EXPECT_EQ(
      std::get<NoFit>(fit).why,
      "the points do not determine the position of the part: it is insensitive to a rotation about "
      "(1, 0, 0) through (100, 0, 0) mm");
}

TEST(BestFitToMesh, ReturnsTheMotionOfAPart) {
  Random random(3);
  const TriangleMesh mesh = m1_part();
  const auto points = points_on(mesh, 400, random);
  for (int n = 0; n < 20; ++n) {
    const Isometry3d motion = small_motion(200.0 * um, 0.05 * deg, random);
    const auto fit = best_fit(moved(points, motion.inverse()), mesh);
    ASSERT_TRUE(std::holds_alternative<BestFit>(fit)) << std::get<NoFit>(fit).why;
    EXPECT_LT(difference(std::get<BestFit>(fit).motion, motion), kMotionTol) << n;
    EXPECT_LT(std::get<BestFit>(fit).rms, kMotionTol);
    EXPECT_EQ(std::get<BestFit>(fit).distances.size(), points.size());
    EXPECT_LT(std::get<BestFit>(fit).steps, 15);
  }
}

// The basin that best_fit.h states.
TEST(BestFitToMesh, FindsTheWayBackFrom10DegAnd10Mm) {
  Random random(4);
  const TriangleMesh mesh = m1_part();
  const auto points = points_on(mesh, 400, random);
  for (int n = 0; n < 15; ++n) {
    const Isometry3d motion =
        small_motion(random.within(0, 10.0) * mm, random.within(0, 10.0) * deg, random);
    const auto fit = best_fit(moved(points, motion.inverse()), mesh);
    ASSERT_TRUE(std::holds_alternative<BestFit>(fit)) << n << " " << std::get<NoFit>(fit).why;
    EXPECT_LT(difference(std::get<BestFit>(fit).motion, motion), kMotionTol) << n;
  }
}

// A quarter turn is another place of the square and the circle, and the diamond's; a start helps.
TEST(BestFitToMesh, BeginsWhereItIsReported) {
  Random random(5);
  const TriangleMesh mesh = m1_part();
  const auto points = points_on(mesh, 300, random);
  const Isometry3d motion = random.pose(0.5);
  const Isometry3d near = small_motion(1.0 * mm, 1.0 * deg, random) * motion;
  const auto fit = best_fit(moved(points, motion.inverse()), mesh, near);
  ASSERT_TRUE(std::holds_alternative<BestFit>(fit));
  EXPECT_LT(difference(std::get<BestFit>(fit).motion, motion), kMotionTol);
}

// With deviations the sum is smallest: no small motion lowers it.
TEST(BestFitToMesh, MakesTheSumOfSquaredDistancesSmallest) {
  Random random(6);
  const TriangleMesh mesh = m1_part();
  auto points = points_on(mesh, 400, random);
  for (Vector3d& p : points) p += random.within(-20.0, 20.0) * um * mesh.closest(p).normal;
  const auto fit = best_fit(moved(points, small_motion(0.2 * mm, 0.1 * deg, random)), mesh);
  ASSERT_TRUE(std::holds_alternative<BestFit>(fit));
  const auto measured = moved(points, Isometry3d::Identity());
  const BestFit& best = std::get<BestFit>(fit);
  EXPECT_NEAR(best.rms, 20.0 * um / std::sqrt(3.0), 1.5 * um) << "uniform deviations";
  const auto again = std::get<BestFit>(best_fit(points, mesh));
  EXPECT_NEAR(again.rms, best.rms, 1e-13);
  const auto sum = [&](const Isometry3d& more) {
    double out = 0.0;
    for (const Vector3d& p : measured)
      out += std::pow(mesh.closest(more * again.motion * p).distance, 2);
    return out;
  };
  const double least = sum(Isometry3d::Identity());
  for (int n = 0; n < 50; ++n) EXPECT_GT(sum(small_motion(0.1 * um, 1.0 * urad, random)), least);
}

TEST(BestFitToMesh, SaysWhatAPlaneLeavesFree) {
  Random random(7);
  std::vector<Vector3d> points;
  for (int i = -2; i <= 2; ++i) {
    for (int k = -2; k <= 2; ++k) points.emplace_back(0.015 * i, 0.015 * k, 2.0 * um);
  }
  const auto fit = best_fit(points, m1_part());
  ASSERT_TRUE(std::holds_alternative<NoFit>(fit));
  EXPECT_EQ(
      std::get<NoFit>(fit).why,
      "the points do not determine the position of the part: it is insensitive to a shift along "
      "(1, 0, 0), a shift along (0, 1, 0) and a rotation about (0, 0, 1) through (0, 0, 0) mm");
}

// The circle is a polygon of 520 sides, and still cannot tell how far it is turned.
TEST(BestFitToMesh, SaysWhatABossLeavesFree) {
  std::vector<Vector3d> points;
  for (int i = 0; i < 36; ++i) {
    const double theta = 10.0 * deg * i + 0.1;
    points.emplace_back(55.0 * mm * std::cos(theta), 55.0 * mm * std::sin(theta),
                        (-2.0 - i % 3) * mm);
    points.emplace_back(30.0 * mm * std::cos(theta), 30.0 * mm * std::sin(theta), 0.0);
  }
  const auto fit = best_fit(points, m1_part());
  ASSERT_TRUE(std::holds_alternative<NoFit>(fit));
  EXPECT_TRUE(std::get<NoFit>(fit).why.starts_with(
      "the points do not determine the position of the part: it is insensitive to a rotation about "
      "(0, 0, 1) through ("))
      << std::get<NoFit>(fit).why;
}

// Six points: three on a plane, two on a side, one on another: just enough.
TEST(BestFitToTargets, ReturnsTheMotionFromSixPoints) {
  Random random(8);
  const std::vector<Vector3d> nominal = {
      {0, 0, 0},           {0.1, 0, 0}, {0, 0.1, 0}, {0.02, -0.05, -0.01}, {0.09, -0.05, -0.01},
      {-0.05, 0.03, -0.01}};
  const std::vector<Vector3d> normals = {{0, 0, 1},  {0, 0, 1},  {0, 0, 1},
                                         {0, -1, 0}, {0, -1, 0}, {-1, 0, 0}};
  for (int n = 0; n < 20; ++n) {
    const Isometry3d motion = small_motion(1.0 * mm, 1.0 * deg, random);
    // a probe stops on the planes, but not on the nominal points of them
    std::vector<Vector3d> measured;
    for (std::size_t i = 0; i < nominal.size(); ++i) {
      measured.push_back(motion.inverse() * (nominal[i] + 1.0 * mm * across(normals[i])));
    }
    const auto fit = best_fit(measured, nominal, normals);
    ASSERT_TRUE(std::holds_alternative<BestFit>(fit)) << std::get<NoFit>(fit).why;
    EXPECT_LT(difference(std::get<BestFit>(fit).motion, motion), kMotionTol);
  }
  const auto five = best_fit(std::span(nominal).first(5), std::span(nominal).first(5),
                             std::span(normals).first(5));
  ASSERT_TRUE(std::holds_alternative<NoFit>(five));
  EXPECT_EQ(
      std::get<NoFit>(five).why,
      "the points do not determine the position of the part: it is insensitive to a shift along "
      "(1, 0, 0)");
}

TEST(Quiver, ShowsDeviationsAtNominalPlaces) {
  const TriangleMesh mesh = m1_part();
  const std::vector<Vector3d> points = {{0.01, 0.02, 3.0 * um},
                                        {80.0 * mm - 5.0 * um, 0.01, -15.0 * mm}};
  const auto arrows = quiver(points, Isometry3d::Identity(), mesh);
  ASSERT_EQ(arrows.size(), 2u);
  constexpr double kSinglePrecision = 5e-9;  // m, of the mesh
  EXPECT_LT((arrows[0].place - Vector3d(0.01, 0.02, 0.0)).norm(), kSinglePrecision);
  EXPECT_LT((arrows[0].deviation - Vector3d(0, 0, 3.0 * um)).norm(), kSinglePrecision);
  EXPECT_LT((arrows[1].deviation - Vector3d(-5.0 * um, 0, 0)).norm(), kSinglePrecision);

  const std::vector<Vector3d> nominal = {{0.01, 0.02, 0.0}, {80.0 * mm, 0.01, -15.0 * mm}},
                              normals = {{0, 0, 1}, {1, 0, 0}};
  const auto along = quiver(points, Isometry3d::Identity(), nominal, normals);
  EXPECT_EQ(along[1].place, nominal[1]);
  EXPECT_LT((along[1].deviation - Vector3d(-5.0 * um, 0, 0)).norm(), kRounding);
}

}  // namespace
}  // namespace servomill::sim::metrology::best_fit_test
