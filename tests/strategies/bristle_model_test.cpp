/// Friction from a velocity, against its steady state and the differential equation.
#include "strategies/bristle_model.h"

#include <gtest/gtest.h>

#include <numbers>

#include "plant/drives/friction.h"

namespace servomill::strategies::bristle_model_test {
namespace {

BristleFriction bristles() {
  BristleFriction p;
  p.Fc_positive = 450.0;
  p.Fs_positive = 560.0;
  p.Fc_negative = 430.0;
  p.Fs_negative = 500.0;
  p.vs = 2e-3;
  p.sigma0 = 5e7;
  p.sigma1 = 3e4;
  return p;
}

// The friction of a machine with the same values.
plant::FrictionParams lugre() {
  const BristleFriction p = bristles();
  return {.kind = plant::FrictionKind::lugre,
          .Fc_positive = p.Fc_positive,
          .Fc_negative = p.Fc_negative,
          .Fs_positive = p.Fs_positive,
          .Fs_negative = p.Fs_negative,
          .vs = p.vs,
          .sigma0 = p.sigma0,
          .sigma1 = p.sigma1};
}

constexpr double kPeriod = 60e-6;  // s

TEST(Bristles, ReachTheForceOfSliding) {
  const BristleFriction p = bristles();
  for (const double v : {1e-4, 3e-3, -1e-4, -0.05}) {
    double z = 0.0, F = 0.0;
    for (int n = 0; n < 30'000; ++n) F = advance_bristles(p, v, kPeriod, z);
    const double g = plant::sliding_force(lugre(), v >= 0.0, v);
    EXPECT_NEAR(F, std::copysign(g, v), 1e-6 * g) << v;
  }
}

TEST(Bristles, StayAsTheyAreAtStandstill) {
  const BristleFriction p = bristles();
  double z = 3e-6;
  for (int n = 0; n < 10; ++n) EXPECT_EQ(advance_bristles(p, 0.0, kPeriod, z), p.sigma0 * 3e-6);
  EXPECT_EQ(z, 3e-6);
}

// A reversal as in experiment 1, against Euler steps of a hundredth of a period.
TEST(Bristles, FollowTheirDifferentialEquation) {
  const BristleFriction p = bristles();
  const plant::FrictionParams actual = lugre();
  const double w = 2.0 * std::numbers::pi * 0.375, most = 353e-6;  // rad/s, m/s
  constexpr int kFine = 100;
  double z = 0.0, fine = 0.0, largest = 0.0;
  for (int n = 0; n < 60'000; ++n) {
    const double F = advance_bristles(p, most * std::sin(w * (n + 0.5) * kPeriod), kPeriod, z);
    double rate = 0.0;
    for (int k = 0; k < kFine; ++k) {
      const double t = (n + (k + 0.5) / kFine) * kPeriod;
      rate = plant::bristle_rate(actual, most * std::sin(w * t), fine);
      fine += kPeriod / kFine * rate;
    }
    largest = std::max(largest, std::abs(F - (p.sigma0 * fine + p.sigma1 * rate)));
  }
  EXPECT_LT(largest, 0.5);  // N, of 560
}

}  // namespace
}  // namespace servomill::strategies::bristle_model_test
