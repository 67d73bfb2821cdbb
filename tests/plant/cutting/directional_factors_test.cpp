#include "plant/cutting/directional_factors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/cutting/cutting_force.h"
#include "plant/vocabulary/units.h"

namespace servomill::plant::directional_factors_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDepth = 2 * mm;

const CuttingCoefficients& steel() { return find_material("42CrMo4")->typical; }

TEST(DirectionalFactors, of_a_slot_with_four_straight_teeth_are_constant) {
  const auto factors =
      directional_factors(steel(), 4, flank_slices(kDepth, 0.0, kPi, 0.0, 5 * mm), 30);
  ASSERT_EQ(factors.size(), 30U);
  Eigen::Matrix2d expected;
  expected << steel().Krc, steel().Ktc, -steel().Ktc, steel().Krc;
  expected *= kDepth;
  for (const Eigen::Matrix2d& A : factors) {
    EXPECT_LT((A - expected).norm(), 1e-12 * expected.norm());
  }
}

// A feed is a displacement between one tooth and the next: the part of the average force that grows
// with it is -A e1.
TEST(DirectionalFactors, on_average_give_the_force_by_feed) {
  const EngagedArc arcs[] = {
      {.width = 1 * mm, .height = 3 * mm, .kappa = 0.5 * kPi, .from = 0.3, .to = 1.4},
      {.width = 0.5 * mm, .height = 0.5 * mm, .kappa = 0.7, .from = 0.5, .to = 2.5}};
  const Cutter cutter{
      .radius = 5 * mm, .corner_radius = 2 * mm, .length = 20 * mm, .teeth = 3, .helix = 30 * deg};
  const FeedDirection feed;
  const auto slices = edge_slices(cutter, feed, arcs);
  Eigen::Matrix2d mean = Eigen::Matrix2d::Zero();
  constexpr int kParts = 24;
  for (const Eigen::Matrix2d& A : directional_factors(steel(), cutter.teeth, slices, kParts)) {
    mean += A / kParts;
  }
  const CuttingForce force = average_force(steel(), cutter.teeth, feed, arcs);
  EXPECT_LT((mean.col(0) + force.shear.head<2>()).norm(), 1e-9 * force.shear.norm());
}

// A flank that is as high as its teeth are apart along the axis is always the same in the cut.
TEST(DirectionalFactors, of_a_depth_of_the_axial_pitch_are_constant) {
  constexpr double kHelix = 30 * deg, kRadius = 4 * mm;
  constexpr int kTeeth = 3;
  const double pitch = 2.0 * kPi * kRadius / (kTeeth * std::tan(kHelix));
  const auto factors =
      directional_factors(steel(), kTeeth, flank_slices(pitch, 0.0, 40 * deg, kHelix, kRadius), 20);
  for (const Eigen::Matrix2d& A : factors) {
    EXPECT_LT((A - factors.front()).norm(), 1e-9 * factors.front().norm());
  }
}

}  // namespace
}  // namespace servomill::plant::directional_factors_test
