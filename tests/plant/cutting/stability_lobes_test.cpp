#include "plant/cutting/stability_lobes.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "tests/plant/cutting/regenerative_cut.h"

namespace servomill::plant::stability_lobes_test {
namespace {

constexpr double kPi = std::numbers::pi;
using Complex = std::complex<double>;

const CuttingCoefficients& steel() { return find_material("42CrMo4")->typical; }

const ChatterMode kNormal{.stiffness = 20e6, .frequency = 2.0 * kPi * 500.0, .damping = 0.03};
const ChatterMode kTwo[] = {{.stiffness = 30e6,
                             .frequency = 2.0 * kPi * 620.0,
                             .damping = 0.02,
                             .direction = Eigen::Vector2d::UnitX()},
                            {.stiffness = 20e6,
                             .frequency = 2.0 * kPi * 500.0,
                             .damping = 0.03,
                             .direction = Eigen::Vector2d(0.6, 0.8)}};

const FlankEngagement kSlot{.coefficients = steel(), .teeth = 4, .from = 0.0, .to = kPi};

// One mode normal to the feed: a = -1 / (2 K_rc Re G).
TEST(StabilityLobes, of_one_mode_are_those_of_Tlusty) {
  for (const double turns : {45.0, 62.0, 80.0, 108.0, 150.0, 400.0}) {
    const StabilityLimit limit = zeroth_order_limit(kSlot, {&kNormal, 1}, turns);
    const double w = 2.0 * kPi * limit.frequency;
    const Complex G = receptance({&kNormal, 1}, w)(1, 1);
    EXPECT_NEAR(limit.depth, -1.0 / (2.0 * steel().Krc * G.real()), 1e-9 * limit.depth);
    // 1 + a K_rc (1 - exp(-i w T)) G = 0
    const double T = 1.0 / (4.0 * turns);
    const Complex zero =
        1.0 + limit.depth * steel().Krc * (1.0 - std::exp(Complex(0.0, -w * T))) * G;
    EXPECT_LT(std::abs(zero), 1e-9) << turns;
  }
}

// Lowest of all lobes: 2 k zeta (1 + zeta) / K_rc, where Re G is least.
TEST(StabilityLobes, have_their_lowest_depth_where_the_receptance_is_least) {
  const double z = kNormal.damping, bound = 2.0 * kNormal.stiffness * z * (1.0 + z) / steel().Krc;
  double lowest = 1.0;
  for (double turns = 40.0; turns < 160.0; turns += 0.25) {
    const double depth = zeroth_order_limit(kSlot, {&kNormal, 1}, turns).depth;
    EXPECT_GT(depth, bound * (1.0 - 1e-12));
    lowest = std::min(lowest, depth);
  }
  EXPECT_NEAR(lowest, bound, 1e-3 * bound);
}

TEST(StabilityLobes, of_two_modes_fulfil_their_equation) {
  Eigen::Matrix2cd A;  // of a depth of 1 m
  A << steel().Krc, steel().Ktc, -steel().Ktc, steel().Krc;
  for (const double turns : {50.0, 77.0, 120.0}) {
    const StabilityLimit limit = zeroth_order_limit(kSlot, kTwo, turns);
    const double w = 2.0 * kPi * limit.frequency, T = 1.0 / (4.0 * turns);
    const Eigen::Matrix2cd M =
        Eigen::Matrix2cd::Identity() +
        limit.depth * (1.0 - std::exp(Complex(0.0, -w * T))) * receptance(kTwo, w) * A;
    EXPECT_LT(std::abs(M.determinant()), 1e-8) << turns;
  }
}

TEST(StabilityLobes, of_constant_factors_are_the_same_by_semi_discretisation) {
  for (const double turns : {45.0, 62.0, 80.0, 108.0, 150.0}) {
    for (const std::span<const ChatterMode> modes :
         {std::span<const ChatterMode>(&kNormal, 1), std::span<const ChatterMode>(kTwo)}) {
      const StabilityLimit closed = zeroth_order_limit(kSlot, modes, turns);
      const StabilityLimit limit = limit_of_stability(kSlot, modes, turns, 20 * closed.depth);
      EXPECT_NEAR(limit.depth, closed.depth, 5e-3 * closed.depth) << turns;
      EXPECT_NEAR(limit.frequency, closed.frequency, 2e-3 * closed.frequency) << turns;
      EXPECT_EQ(limit.kind, Chatter::hopf);
    }
  }
}

// Simulated limits of regeneration.h, whose own test holds them against another
// semi-discretisation; one of them is a flip.
TEST(StabilityLobes, at_low_immersion_are_those_of_a_simulation) {
  int flips = 0;
  for (const double turns : {130.0, 170.0, 190.0, 310.0, 350.0, 420.0}) {
    SteadyCut cut{.coefficients = steel(), .teeth = 2, .to = 12.8 * deg, .turns = turns};
    const double simulated = stable_depth(cut, kNormal, 100 * mm, 300);
    const FlankEngagement engagement{
        .coefficients = steel(), .teeth = 2, .from = 0.0, .to = 12.8 * deg};
    const StabilityLimit limit = limit_of_stability(engagement, {&kNormal, 1}, turns, 100 * mm);
    EXPECT_NEAR(limit.depth, simulated, 0.02 * simulated) << turns;
    flips += limit.kind == Chatter::flip ? 1 : 0;
  }
  EXPECT_GE(flips, 1) << "period doubling";
}

// At a depth of the axial pitch of its teeth the factors of a helical cutter are constant. The
// coefficients are scaled until the closed form has its limit there.
TEST(StabilityLobes, of_a_helical_cutter_are_exact_at_its_axial_pitch) {
  FlankEngagement cut{.coefficients = steel(),
                      .teeth = 2,
                      .from = 0.0,
                      .to = 40 * deg,
                      .helix = 30 * deg,
                      .radius = 4 * mm};
  const double pitch = 2.0 * kPi * cut.radius / (cut.teeth * std::tan(cut.helix));
  for (const double turns : {150.0, 230.0}) {
    cut.coefficients = steel();
    const double factor = zeroth_order_limit(cut, kTwo, turns).depth / pitch;
    cut.coefficients.Ktc *= factor;
    cut.coefficients.Krc *= factor;
    ChatterAnalysis analysis(kTwo);
    EXPECT_TRUE(analysis.of(cut.at(0.97 * pitch, turns)).is_stable()) << turns;
    EXPECT_NEAR(std::abs(analysis.of(cut.at(pitch, turns)).multiplier), 1.0, 1e-3) << turns;
  }
}

TEST(StabilityLobes, are_without_a_limit_where_no_mode_is_excited) {
  const ChatterMode along{.stiffness = 20e6,
                          .frequency = 3000.0,
                          .damping = 0.03,
                          .direction = Eigen::Vector2d::UnitY()};
  FlankEngagement cut = kSlot;
  cut.coefficients.Krc = 0.0;  // d . A_0 d = 0
  EXPECT_TRUE(std::isinf(zeroth_order_limit(cut, {&along, 1}, 80.0).depth));
  EXPECT_TRUE(std::isinf(limit_of_stability(cut, {&along, 1}, 80.0, 5 * mm).depth));
}

}  // namespace
}  // namespace servomill::plant::stability_lobes_test
