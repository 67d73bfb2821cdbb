// Signed distances of bodies that a probe meets: closed forms, and the laws that the search for a
// touch rests on.
#include "sim/metrology/probed_bodies.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

namespace servomill::sim::metrology::probed_bodies_test {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 1e-15;

const plant::StockBox kBox{{-2.0, -1.0, -0.5}, {2.0, 1.0, 0.5}, 0.0};

TriangleMesh mesh_of_box() {
  Triangles t;
  for (int k = 0; k < 8; ++k) {
    t.corners.emplace_back((k & 1) != 0 ? 2.0 : -2.0, (k & 2) != 0 ? 1.0 : -1.0,
                           (k & 4) != 0 ? 0.5 : -0.5);
  }
  t.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return TriangleMesh(std::move(t));
}

std::vector<ProbedBody> one_of_each() {
  const Eigen::Isometry3d motion =
      Eigen::Translation3d(0.3, -0.2, 0.1) * Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized());
  return {
      SphereBody{{0.1, 0.2, 0.3}, 0.8},
      PlaneBody{{0.0, 0.0, -1.0}, Vector3d(1, 1, 1).normalized()},
      BoreBody{{0.2, 0.1}, 1.2, -0.7, 0.4},
      DisplacedBody{plant::StockSolid(plant::StockBox{{-2, -1, -0.5}, {2, 1, 0.5}, 0.4}), motion},
      DisplacedBody{plant::StockSolid(plant::StockCylinder{{0.1, 0.0}, 0.9, -1.0, 0.3}), motion},
      DisplacedBody{std::make_shared<const TriangleMesh>(mesh_of_box()), motion}};
}

TEST(ProbedBodies, HaveTheDistancesOfTheirShapes) {
  EXPECT_NEAR(signed_distance(SphereBody{{1, 0, 0}, 2.0}, {1, 3, 4}), 3.0, kRounding);
  EXPECT_NEAR(signed_distance(PlaneBody{{0, 0, 1}, {0, 0, 1}}, {7, 8, 0.5}), -0.5, kRounding);
  const DisplacedBody box{plant::StockSolid(kBox)};
  EXPECT_NEAR(signed_distance(box, {0, 0, 1.5}), 1.0, kRounding);   // face
  EXPECT_NEAR(signed_distance(box, {0, 4, 4.5}), 5.0, kRounding);   // edge: 3, 4
  EXPECT_NEAR(signed_distance(box, {4, 4, 6.5}), 7.0, kRounding);   // corner: 2, 3, 6
  EXPECT_NEAR(signed_distance(box, {1.9, 0, 0}), -0.1, kRounding);  // inside
  const DisplacedBody cylinder{plant::StockSolid(plant::StockCylinder{{0, 0}, 2.0, -1.0, 1.0})};
  EXPECT_NEAR(signed_distance(cylinder, {3, 4, 0}), 3.0, kRounding);  // flank
  EXPECT_NEAR(signed_distance(cylinder, {3, 4, 5}), 5.0, kRounding);  // edge: 3, 4
  EXPECT_NEAR(signed_distance(cylinder, {0, 0, 3}), 2.0, kRounding);  // end
  const BoreBody bore{{0, 0}, 2.0, -1.0, 1.0};
  EXPECT_NEAR(signed_distance(bore, {0, 0.5, 0}), 1.5, kRounding);             // in the bore
  EXPECT_NEAR(signed_distance(bore, {0, 3, 3}), 2.0, kRounding);               // above the plate
  EXPECT_NEAR(signed_distance(bore, {0, -1, 4}), std::sqrt(10.0), kRounding);  // edge: 1, 3
  EXPECT_NEAR(signed_distance(bore, {5, 0, 0.8}), -0.2, kRounding);            // in the plate
}

TEST(ProbedBodies, AreTheSameAsAMeshAndAsASolid) {
  const DisplacedBody solid{plant::StockSolid(kBox)};
  const DisplacedBody mesh{std::make_shared<const TriangleMesh>(mesh_of_box())};
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(-3.0, 3.0);
  for (int n = 0; n < 500; ++n) {
    const Vector3d p(place(random), place(random), place(random));
    EXPECT_NEAR(signed_distance(solid, p), signed_distance(mesh, p), 1e-12) << p.transpose();
  }
}

TEST(ProbedBodies, ComeNoFasterThanThePlaceMoves) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> place(-3.0, 3.0);
  for (const ProbedBody& body : one_of_each()) {
    for (int n = 0; n < 300; ++n) {
      const Vector3d p(place(random), place(random), place(random));
      const Vector3d q(place(random), place(random), place(random));
      const double change = std::abs(signed_distance(body, p) - signed_distance(body, q));
      EXPECT_LE(change, (p - q).norm() + 1e-12) << body.index();
    }
  }
}

TEST(ProbedBodies, MeetTheirSurfaceAlongTheNormal) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-3.0, 3.0);
  for (const ProbedBody& body : one_of_each()) {
    for (int n = 0; n < 100; ++n) {
      const Vector3d p(place(random), place(random), place(random));
      const double d = signed_distance(body, p);
      if (d < 0.05) continue;
      const Vector3d surface = p - d * outward_normal({body}, p);
      EXPECT_NEAR(signed_distance(body, surface), 0.0, 1e-6) << body.index();
    }
  }
}

TEST(ProbedBodies, OfAUnionTheNearestCounts) {
  const std::vector<ProbedBody> two = {SphereBody{{0, 0, 0}, 1.0}, SphereBody{{10, 0, 0}, 2.0}};
  EXPECT_NEAR(signed_distance(two, {3, 0, 0}), 2.0, kRounding);
  EXPECT_NEAR(signed_distance(two, {7, 0, 0}), 1.0, kRounding);
  EXPECT_NEAR((outward_normal(two, {7, 0, 0}) + Vector3d::UnitX()).norm(), 0.0, 1e-6);
  EXPECT_TRUE(std::isinf(signed_distance(std::vector<ProbedBody>(), {0, 0, 0})));
}

}  // namespace
}  // namespace servomill::sim::metrology::probed_bodies_test
