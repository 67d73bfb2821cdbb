#include "plant/drives/friction.h"

#include <gtest/gtest.h>

namespace servomill::plant::friction_test {
namespace {

FrictionParams asymmetric() {
  return {.kind = FrictionKind::regularised,
          .Fc_positive = 450,
          .Fc_negative = 300,
          .Fs_positive = 560,
          .Fs_negative = 400,
          .b_positive = 700,
          .b_negative = 250,
          .vs = 2e-3,
          .v0 = 1e-4,
          .sigma0 = 5e7,
          .sigma1 = 3e4};
}

TEST(Friction, FallsFromBreakawayToCoulomb) {
  const FrictionParams p = asymmetric();
  EXPECT_EQ(sliding_force(p, true, 0.0), 560.0);
  EXPECT_EQ(sliding_force(p, false, 0.0), 400.0);
  EXPECT_DOUBLE_EQ(sliding_force(p, true, p.vs), 450.0 + 110.0 * std::exp(-1.0) + 700.0 * p.vs);
  EXPECT_DOUBLE_EQ(sliding_force(p, false, -p.vs), 300.0 + 100.0 * std::exp(-1.0) + 250.0 * p.vs);
}

TEST(Friction, RisesFromABreakawayBelowCoulomb) {
  FrictionParams p = asymmetric();
  p.Fs_positive = 200.0;
  EXPECT_EQ(sliding_force(p, true, 0.0), 200.0);
  EXPECT_DOUBLE_EQ(sliding_force(p, true, p.vs), 450.0 - 250.0 * std::exp(-1.0) + 700.0 * p.vs);
  EXPECT_GT(sliding(p, true, p.vs).slope, 700.0);
}

TEST(Friction, LosesNothingWhereTheStribeckTermEnds) {
  FrictionParams p = asymmetric();
  p.b_positive = p.b_negative = 0.0;
  const double inside = kStribeckEnd * p.vs * (1 - 1e-12), outside = kStribeckEnd * p.vs * 1.001;
  EXPECT_EQ(sliding_force(p, true, inside), sliding_force(p, true, outside));
  EXPECT_EQ(regularised_force(p, outside), 450.0);
  EXPECT_EQ(regularised_force(p, -outside), -300.0);
}

TEST(Friction, SlopesAreTheDerivatives) {
  constexpr double kSlopeTol = 1e-6;  // relative, central differences at 1e-6 of the speed scale
  const FrictionParams p = asymmetric();
  for (const double v : {-5e-3, -1e-3, -5e-5, 3e-5, 2e-4, 1e-3, 4e-3}) {
    const double d = 1e-6 * p.v0;
    const double g = (sliding_force(p, v > 0, v + d) - sliding_force(p, v > 0, v - d)) / (2 * d);
    const double f = (regularised_force(p, v + d) - regularised_force(p, v - d)) / (2 * d);
    const double scale = p.Fs_positive / p.v0;
    EXPECT_NEAR(sliding(p, v > 0, v).slope, g, kSlopeTol * scale) << v;
    EXPECT_NEAR(regularised(p, v).slope, f, kSlopeTol * scale) << v;
  }
}

TEST(Friction, BristlesCarryTheSlidingForceInSteadyMotion) {
  const FrictionParams p = asymmetric();
  for (const double v : {-0.1, -1e-3, 1e-3, 0.1}) {
    const double force = std::copysign(sliding_force(p, v > 0, v), v);
    const double z = force / p.sigma0;
    EXPECT_NEAR(bristle_rate(p, v, z), 0.0, 1e-15 * std::abs(v));
    EXPECT_DOUBLE_EQ(bristle_force(p, v, z), force);
  }
}

}  // namespace
}  // namespace servomill::plant::friction_test
