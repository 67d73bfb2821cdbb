#include "plant/cutting/vibrating_teeth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/cutting/directional_factors.h"
#include "plant/vocabulary/units.h"

namespace servomill::plant::vibrating_teeth_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kFeed = 50 * um;  // per tooth

const CuttingCoefficients& steel() { return find_material("42CrMo4")->typical; }

const Cutter kHelical{
    .radius = 5 * mm, .corner_radius = 1 * mm, .length = 20 * mm, .teeth = 3, .helix = 30 * deg};
const EngagedArc kArcs[] = {
    {.width = 4 * mm, .height = 3 * mm, .from = 0.2, .to = 2.0},
    {.width = 0.4 * mm, .height = 0.5 * mm, .kappa = 0.8, .from = 0.2, .to = 2.0}};

PassageDifferences same_for_all(const Vector2d& x) {
  PassageDifferences out;
  out.fill(x);
  return out;
}

Vector3d vibrating(const Cutter& cutter, std::span<const EdgeSlice> slices, double phi,
                   const PassageDifferences& between, double c = kFeed) {
  return mean_vibrating_force(steel(), radius_offsets(cutter), slices, {phi, 3 * deg}, c, 1.0,
                              between);
}

TEST(VibratingTeeth, without_vibration_have_the_force_of_the_feed) {
  const auto slices = edge_slices(kHelical, {}, kArcs);
  const ToothChips chips(kHelical);
  for (double phi = 0.0; phi < 2.0 * kPi; phi += 0.1) {
    const Vector3d force =
        vibrating(kHelical, short_slices(slices), phi, same_for_all(Vector2d::Zero()));
    const Vector3d expected = mean_tooth_force(steel(), chips, slices, phi, 3 * deg, kFeed);
    EXPECT_LT((force - expected).norm(), 1e-9 * (1.0 + expected.norm())) << phi;
  }
}

// Run-out beyond the feed: a tooth in two or three cuts nothing. The surface is chosen once a step.
TEST(VibratingTeeth, run_out_as_without_vibration) {
  Cutter cutter = kHelical;
  cutter.runout = 80 * um;
  const auto slices = edge_slices(cutter, {}, kArcs);
  const ToothChips chips(cutter);
  Vector3d sum = Vector3d::Zero(), expected = Vector3d::Zero();
  for (int n = 0; n < 120; ++n) {
    sum += vibrating(cutter, short_slices(slices), n * 3 * deg, same_for_all(Vector2d::Zero()));
    expected += mean_tooth_force(steel(), chips, slices, n * 3 * deg, 3 * deg, kFeed);
  }
  EXPECT_LT((sum - expected).norm(), 1e-2 * expected.norm());
}

// As long as all teeth stay in the cut: F changes by -A (x - x_1).
TEST(VibratingTeeth, respond_to_small_displacements_by_the_directional_factors) {
  const auto slices = edge_slices(kHelical, {}, kArcs);
  constexpr int kParts = 40;  // of 120 deg: 3 deg each
  const auto factors = directional_factors(steel(), kHelical.teeth, slices, kParts);
  for (const Vector2d& x :
       {Vector2d(2 * um, 0.0), Vector2d(0.0, 1 * um), Vector2d(-1 * um, 1 * um)}) {
    for (int n = 0; n < kParts; ++n) {
      PassageDifferences between = same_for_all(Vector2d::Zero());
      const Vector3d rest = vibrating(kHelical, short_slices(slices), n * 3 * deg, between);
      between[0] = x;
      const Vector3d force = vibrating(kHelical, short_slices(slices), n * 3 * deg, between);
      const Vector2d change = -factors[static_cast<std::size_t>(n)] * x;
      EXPECT_LT(((force - rest).head<2>() - change).norm(), 1e-9 + 1e-9 * change.norm()) << n;
    }
  }
}

TEST(VibratingTeeth, that_have_left_the_cut_feel_nothing) {
  const auto slices = short_slices(edge_slices(kHelical, {}, kArcs));
  for (double phi = 0.0; phi < 2.0 * kPi; phi += 0.1) {
    const Vector2d away(-1 * mm, 0.0);  // r . x < 0 where sin(phi) > 0
    EXPECT_EQ(vibrating(kHelical, slices, phi, same_for_all(away)).norm(), 0.0) << phi;
  }
}

// The tooth before was out of the cut: what the one before it has left is met, two feeds away.
TEST(VibratingTeeth, meet_the_surface_of_the_tooth_that_has_cut) {
  Cutter straight = kHelical;
  straight.helix = 0.0;
  straight.corner_radius = 0.0;
  const EngagedArc arc{.width = 2 * mm, .height = 1 * mm, .from = 0.0, .to = kPi};
  const auto slices = short_slices(edge_slices(straight, {}, {&arc, 1}));
  PassageDifferences between = same_for_all(Vector2d::Zero());
  between[0] = Vector2d(1 * mm, 0.0);  // the tooth before was 1 mm behind
  const Vector3d force = vibrating(straight, slices, 0.5 * kPi, between);
  const Vector3d twice =
      vibrating(straight, slices, 0.5 * kPi, same_for_all(Vector2d::Zero()), 2.0 * kFeed);
  EXPECT_LT((force - twice).norm(), 1e-9);
}

TEST(VibratingTeeth, slices_keep_their_width_and_lag) {
  const auto slices = edge_slices(kHelical, {}, kArcs);
  const auto parts = short_slices(slices);
  double width = 0.0, lag = slices.front().lag;
  for (const EdgeSlice& part : parts) {
    if (part.lag_span == 0.0) continue;
    EXPECT_LE(part.lag_span, 5.0001 * deg);
    EXPECT_NEAR(part.lag, lag, 1e-12);
    lag += part.lag_span;
    width += part.width;
  }
  EXPECT_NEAR(width, 4 * mm, 1e-12);
  EXPECT_GT(parts.size(), slices.size());
}

}  // namespace
}  // namespace servomill::plant::vibrating_teeth_test
