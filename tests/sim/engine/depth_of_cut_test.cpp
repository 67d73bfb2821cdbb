#include "sim/engine/depth_of_cut.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::sim::engine::depth_of_cut_test {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

// A wall in Y: 2 N per um of depth towards +Y, pushed to -Y; nothing changes along Z.
constexpr double kSlope = 2.0;  // N/um
struct Wall {
  DisplacedCut cut{.across = {Vector3d::UnitY(), Vector3d::UnitZ()}, .at = {}};
  Vector3d nominal{-10.0, -40.0, 0.0};
  std::array<ForcesNearby, 2> places;

  Wall() {
    const double change = kSlope * DisplacedCut::kStep / um;
    const Vector3d F_y = Vector3d(0.0, -change, 0.0);
    places[0] = {0.3, &cut, nominal, {nominal + F_y, nominal - F_y, nominal, nominal}};
    places[1] = places[0];
    places[1].share = 0.7;
  }
};

constexpr double kRounding = 1e-9;  // N

TEST(DepthOfCut, force_is_linear_in_the_displacement_across_the_feed) {
  const Wall wall;
  for (const double y : {-15.0, 0.0, 5.0}) {
    const Vector3d F =
        force_at_actual_depth(wall.places, Vector3d(30.0, y, 3.0) * um, Matrix3d::Zero()).force;
    EXPECT_LE((F - Vector3d(-10.0, -40.0 - kSlope * y, 0.0)).norm(), kRounding) << y;
  }
}

// k of the cut and of the structure in balance: F = (F_0 + k_c d) / (1 + k_c / k).
TEST(DepthOfCut, force_is_in_balance_with_the_structure_that_it_bends) {
  const Wall wall;
  Matrix3d C = Matrix3d::Zero();
  C(1, 1) = 1.0 / (1e6 * 20.0);  // 20 N/um
  const double F = force_at_actual_depth(wall.places, Vector3d(0.0, 5.0, 0.0) * um, C).force.y();
  EXPECT_NEAR(F, -(40.0 + kSlope * 5.0) / (1.0 + kSlope / 20.0), kRounding);
}

TEST(DepthOfCut, force_ends_where_the_cutter_leaves_the_material) {
  Wall wall;
  for (ForcesNearby& place : wall.places) {
    place.nominal.x() = 0.0;
    for (Vector3d& F : place.displaced) F.x() = 0.0;
  }
  const auto at = [&](double y) {
    return force_at_actual_depth(wall.places, Vector3d(0.0, y, 0.0) * um, Matrix3d::Zero())
        .force.y();
  };
  EXPECT_NEAR(at(-19.0), -2.0, kRounding);
  EXPECT_EQ(at(-21.0), 0.0);
  EXPECT_NEAR(at(99.0), -40.0 - 198.0, kRounding);
  EXPECT_NEAR(at(500.0), -40.0 - 200.0, kRounding) << "extended to 0.1 mm";
}

TEST(DepthOfCut, of_places_without_displaced_cuts_is_the_nominal_one) {
  Wall wall;
  wall.places[1].cut = nullptr;
  const Vector3d F =
      force_at_actual_depth(wall.places, Vector3d(0.0, 5.0, 0.0) * um, Matrix3d::Zero()).force;
  EXPECT_NEAR(F.y(), -40.0 - 0.3 * kSlope * 5.0, kRounding);
  wall.places[0] = {};
  wall.places[1] = {};
  EXPECT_TRUE(force_at_actual_depth(wall.places, Vector3d(0.0, 5.0, 0.0) * um, Matrix3d::Zero())
                  .force.isZero(0.0));
}

// The following error along the feed is no distance from the path.
TEST(DepthOfCut, lag_along_the_feed_does_not_shorten_the_displacement) {
  const Wall wall;
  const ForceAtDepth found =
      force_at_actual_depth(wall.places, Vector3d(400.0, 50.0, 0.0) * um, Matrix3d::Zero());
  EXPECT_NEAR(found.force.y(), -40.0 - kSlope * 50.0, kRounding);
  EXPECT_NEAR(found.off_path, 50 * um, 1e-15);
}

TEST(DepthOfCut, distance_from_the_path_includes_the_deflection) {
  const Wall wall;
  Matrix3d C = Matrix3d::Zero();
  C(1, 1) = 1.0 / (1e6 * 20.0);  // 20 N/um
  const ForceAtDepth found = force_at_actual_depth(wall.places, Vector3d(0.0, 150.0, 0.0) * um, C);
  EXPECT_NEAR(found.off_path, std::abs(150 * um + found.force.y() / 20e6), 1e-15);
  EXPECT_FALSE(found.digs_in);
}

// A wall that draws the cutter in: F = (F_0 + k_c d) / (1 - k_c / k) as long as k_c < k.
TEST(DepthOfCut, tool_digs_in_where_the_cut_is_stiffer_than_the_structure) {
  Wall wall;
  for (ForcesNearby& place : wall.places) {
    place.nominal = -place.nominal;
    for (Vector3d& F : place.displaced) F = -F;
  }
  for (const double k : {2.2, 1.9}) {  // N/um
    Matrix3d C = Matrix3d::Zero();
    C(1, 1) = 1.0 / (k * 1e6);
    const ForceAtDepth found = force_at_actual_depth(wall.places, Vector3d::Zero(), C);
    EXPECT_EQ(found.digs_in, k < kSlope) << k;
    if (k > kSlope) {
      EXPECT_NEAR(found.force.y(), 40.0 / (1.0 - kSlope / k), 1e-6);
    }
  }
}

}  // namespace
}  // namespace servomill::sim::engine::depth_of_cut_test
