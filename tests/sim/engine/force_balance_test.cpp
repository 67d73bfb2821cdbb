/// Forces that depend on the deflection under themselves.
#include "sim/engine/force_balance.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

namespace servomill::sim::engine::force_balance_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kTol = 1e-6;  // N, of some hundred

TEST(ForceBalance, OfALinearForceIsThatOfTheEquation) {
  Matrix3d A;
  A << -0.8, 0.3, 0.0, -0.2, -5.0, 0.1, 0.0, 0.4, -0.5;  // a plain iteration would diverge
  const Vector3d b(100.0, -250.0, 30.0);
  const ForceBalance found =
      balanced_force(Vector3d::Zero(), [&](const Vector3d& F) { return (b + A * F).eval(); });
  EXPECT_TRUE(found.exists);
  EXPECT_LT((found.force - (Matrix3d::Identity() - A).inverse() * b).norm(), kTol);
}

// F = max(0, 100 - 3 F): in the cut 25 N, whichever side the guess is on.
TEST(ForceBalance, IsFoundFromBothSidesOfAKink) {
  for (const double guess : {-1e3, 0.0, 25.0, 1e4}) {
    const ForceBalance found = balanced_force(Vector3d(0.0, guess, 0.0), [](const Vector3d& F) {
      return Vector3d(0.0, std::max(0.0, 100.0 - 3.0 * F.y()), 0.0);
    });
    EXPECT_TRUE(found.exists);
    EXPECT_NEAR(found.force.y(), 25.0, kTol) << guess;
  }
}

// A cut that draws the tool in: F = 100 + 2 F has the balance -100, against which it does not push.
TEST(ForceBalance, DoesNotExistWhereTheForceGrowsFasterThanItIsResisted) {
  const auto drawn_in = [](double share) {
    return balanced_force(Vector3d::Zero(), [share](const Vector3d& F) {
      return Vector3d(100.0 + share * F.x(), 0.0, 0.0);
    });
  };
  EXPECT_TRUE(drawn_in(0.99).exists);
  EXPECT_FALSE(drawn_in(1.01).exists);
  EXPECT_FALSE(drawn_in(2.0).exists);
}

}  // namespace
}  // namespace servomill::sim::engine::force_balance_test
