#include "sim/metrology/minimum_zone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "plant/vocabulary/units.h"
#include "tests/sim/metrology/random_poses.h"

namespace servomill::sim::metrology::minimum_zone_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kRounding = 1e-15;  // m, of some operations on lengths of 0.5 m
constexpr double kZoneTol = 1e-14;   // m: the search ends at a gain of 1e-12 of zones of 10 um

Vector2d turned(const Vector2d& p, double angle) {
  return {std::cos(angle) * p.x() - std::sin(angle) * p.y(),
          std::sin(angle) * p.x() + std::cos(angle) * p.y()};
}

TEST(MinimumZoneLine, OfAZigzagIsItsHeight) {
  Random random(1);
  for (int n = 3; n < 60; ++n) {
    const double angle = random.within(0.0, kTurn), h = 3.0 * um;
    std::vector<Vector2d> points;
    for (int i = 0; i < n; ++i) {
      points.push_back(Vector2d(0.4, 0.3) + turned({0.002 * i, i % 2 ? h : 0.0}, angle));
    }
    // three points are a triangle, whose lowest height stands on the longest side: still h
    const auto zone = minimum_zone_line(points);
    ASSERT_TRUE(zone);
    EXPECT_NEAR(zone->width, h, kRounding) << n;
    EXPECT_LT((zone->middle.direction - turned({1.0, 0.0}, angle)).norm(), 1e-12);
    const Spread spread = spread_about(points, zone->middle);
    EXPECT_NEAR(spread.high, 0.5 * h, kRounding);
    EXPECT_NEAR(spread.low, -0.5 * h, kRounding);
  }
}

// An arc's ends and middle alternate: the width is its sagitta, and the line is that through the
// ends.
TEST(MinimumZoneLine, OfAnArcIsItsSagitta) {
  const double r = 10.0, half = 0.005;
  std::vector<Vector2d> points;
  for (int i = -50; i <= 50; ++i) {
    points.emplace_back(r * std::sin(half * i / 50), r * (std::cos(half * i / 50) - 1.0));
  }
  constexpr double kSagittaRounding = 1e-14;  // m, of cosines times 10 m
  EXPECT_NEAR(minimum_zone_line(points)->width, r * (1.0 - std::cos(half)), kSagittaRounding);
}

// The width of a set is reached across a line through two of its points: all pairs tried.
TEST(MinimumZoneLine, AgreesWithAllPairsTried) {
  Random random(2);
  for (int n = 0; n < 500; ++n) {
    const double height = std::pow(10.0, random.within(-7.0, -1.0));  // m
    std::vector<Vector2d> points;
    for (int i = 0; i < 2 + n % 30; ++i) {
      points.emplace_back(random.within(0.0, 0.1), random.within(0.0, height));
    }
    if (n % 5 == 0) points.push_back(points.front());  // twice
    double best = std::numeric_limits<double>::infinity();
    for (const Vector2d& a : points) {
      for (const Vector2d& b : points) {
        if (a == b) continue;
        best = std::min(best, spread_about(points, Line2{a, (b - a).normalized()}).range());
      }
    }
    const auto zone = minimum_zone_line(points);
    ASSERT_TRUE(zone);
    EXPECT_NEAR(zone->width, best, kRounding) << n;
    EXPECT_NEAR(spread_about(points, zone->middle).range(), best, kRounding) << n;
  }
}

TEST(MinimumZoneLine, OfPointsOnALineOrInOnePlace) {
  std::vector<Vector2d> points(3, Vector2d(0.1, 0.2));
  EXPECT_FALSE(minimum_zone_line(points));
  EXPECT_FALSE(minimum_zone_line(std::vector<Vector2d>{}));
  points.emplace_back(0.3, 0.6);
  points.emplace_back(0.2, 0.4);
  EXPECT_NEAR(minimum_zone_line(points)->width, 0.0, kRounding);
}

// Two high and two low corners, crosswise: whatever way it tilts, it goes away from one of them.
TEST(MinimumZonePlane, OfASaddleIsItsHeight) {
  Random random(3);
  for (int n = 0; n < 20; ++n) {
    const double h = 7.0 * um;
    const Eigen::Isometry3d pose = random.pose(0.3);
    std::vector<Vector3d> points;
    for (int i = -5; i <= 5; ++i) {
      for (int k = -4; k <= 4; ++k) {
        points.push_back(pose * Vector3d(0.1 * i / 5.0, 0.03 * k / 4.0, h * i / 5.0 * k / 4.0));
      }
    }
    const auto zone = minimum_zone_plane(points, pose.linear().col(2));
    ASSERT_TRUE(zone);
    EXPECT_NEAR(zone->width, 2.0 * h, kZoneTol);
    EXPECT_LT(rotation_between(pose.linear().col(2), zone->middle.normal).norm(), 1e-12);
  }
}

// One high point within the triangle of three low ones; least squares tilts, the zone does not.
TEST(MinimumZonePlane, OfAPyramidIsItsHeight) {
  const double h = 5.0 * um;
  std::vector<Vector3d> points = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0.02, 0.01, h}};
  for (int i = 0; i < 20; ++i) points.emplace_back(0.003 * i, 0.0, 0.4 * h);
  const auto zone = minimum_zone_plane(points, Vector3d::UnitZ());
  EXPECT_NEAR(zone->width, h, kZoneTol);
  EXPECT_NEAR(zone->middle.normal.z(), 1.0, kRounding);
  EXPECT_GT(spread_about(points, *least_squares_plane(points, Vector3d::UnitZ())).range(),
            h + 0.1 * um);
}

// Three points touch one plane and one the other, or two and two: all such normals tried.
TEST(MinimumZonePlane, AgreesWithAllCandidatesTried) {
  Random random(4);
  for (int n = 0; n < 100; ++n) {
    const double height = n % 2 ? 10.0 * um : 1.0 * mm;
    const Eigen::Isometry3d pose = random.pose(0.3);
    std::vector<Vector3d> points;
    for (int i = 0; i < 5 + n % 6; ++i) {
      points.push_back(pose * Vector3d(random.within(-0.1, 0.1), random.within(-0.05, 0.05),
                                       random.within(0.0, height)));
    }
    std::vector<Vector3d> edges;
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = i + 1; j < points.size(); ++j) edges.push_back(points[j] - points[i]);
    }
    double best = std::numeric_limits<double>::infinity();
    for (const Vector3d& a : edges) {
      for (const Vector3d& b : edges) {
        const Vector3d normal = a.cross(b);
        if (normal.norm() < 1e-8) continue;
        const Plane plane{points.front(), normal.normalized()};
        best = std::min(best, spread_about(points, plane).range());
      }
    }
    const auto zone = minimum_zone_plane(points, Vector3d::UnitZ());
    ASSERT_TRUE(zone);
    // five random points may lie close to a line, where a plane on edge is as narrow
    if (points.size() > 6) {
      EXPECT_NEAR(zone->width, best, 1e-12 * height + kRounding) << n;
    }
    EXPECT_GE(zone->width, best - kRounding) << n;
  }
}

TEST(MinimumZonePlane, OfManyPointsGrowsWithEveryTilt) {
  Random random(5);
  std::vector<Vector3d> points;
  for (int i = 0; i < 5000; ++i) {
    const double x = random.within(-0.1, 0.1), y = random.within(-0.05, 0.05);
    points.emplace_back(x, y,
                        20.0 * um * std::sin(40.0 * x) * y / 0.05 + random.within(0.0, 2.0 * um));
  }
  const auto zone = minimum_zone_plane(points, Vector3d::UnitZ());
  ASSERT_TRUE(zone);
  EXPECT_LE(zone->width,
            spread_about(points, *least_squares_plane(points, Vector3d::UnitZ())).range());
  for (int n = 0; n < 200; ++n) {
    Plane tilted = zone->middle;
    tilted.normal = (tilted.normal + 1e-8 * random.direction()).normalized();
    EXPECT_GE(spread_about(points, tilted).range(), zone->width - kRounding);
  }
}

TEST(MinimumZonePlane, IsNotDeterminedByPointsOfALine) {
  EXPECT_FALSE(minimum_zone_plane(std::vector<Vector3d>{{0, 0, 0}, {1, 1, 0}, {2, 2, 0}},
                                  Vector3d::UnitZ()));
}

// Three bumps at each end and in the middle hold the axis in shift and slope.
TEST(MinimumZoneCylinder, OfBumpsOnAllSidesIsTheirHeight) {
  Random random(6);
  for (int n = 0; n < 5; ++n) {
    const double h = 5.0 * um;
    const Eigen::Isometry3d pose = random.pose(0.3);
    std::vector<Vector3d> points;
    for (int k = 0; k < 5; ++k) {
      for (int i = 0; i < 36; ++i) {
        const double r = 30.0 * mm + (i % 12 == 0 ? h : 0.0), theta = kTurn * i / 36;
        points.push_back(pose * Vector3d(r * std::cos(theta), r * std::sin(theta), 0.02 * k));
      }
    }
    const auto zone = minimum_zone_cylinder(points, pose.linear().col(2));
    ASSERT_TRUE(zone);
    EXPECT_NEAR(zone->width, h, kZoneTol);
  }
}

TEST(MinimumZoneCylinder, GrowsWithEveryMotion) {
  Random random(7);
  const Eigen::Isometry3d pose = random.pose(0.3);
  std::vector<Vector3d> points;
  for (int k = 0; k < 6; ++k) {
    for (int i = 0; i < 60; ++i) {
      const double r = 30.0 * mm + random.within(0.0, 10.0 * um), theta = kTurn * i / 60;
      points.push_back(pose * Vector3d(r * std::cos(theta), r * std::sin(theta), 0.02 * k));
    }
  }
  const auto zone = minimum_zone_cylinder(points, pose.linear().col(2));
  ASSERT_TRUE(zone);
  EXPECT_LT(zone->width,
            spread_about(points, *least_squares_cylinder(points, pose.linear().col(2))).range());
  for (int n = 0; n < 500; ++n) {
    Cylinder moved = zone->middle;
    moved.point += 1e-10 * random.direction();
    moved.direction = (moved.direction + 1e-9 * random.direction()).normalized();
    EXPECT_GE(spread_about(points, moved).range(), zone->width - kRounding);
  }
}

}  // namespace
}  // namespace servomill::sim::metrology::minimum_zone_test
