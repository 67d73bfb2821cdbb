/// Factors of covariances.
#include "sim/model/joint_normal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace servomill::sim::model::joint_normal_test {
namespace {

// Covariance of rank `rank` with standard deviations over many orders of magnitude, as units give.
Eigen::MatrixXd random_covariance(std::mt19937_64& random, Eigen::Index size, Eigen::Index rank) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd factor(size, rank);
  for (double& x : factor.reshaped()) x = normal(random);
  for (Eigen::Index i = 0; i < size; ++i) factor.row(i) *= std::pow(10.0, 3.0 * normal(random));
  const Eigen::MatrixXd product = factor * factor.transpose();
  return 0.5 * (product + product.transpose());
}

TEST(CovarianceFactor, GivesTheCovarianceWithAsManyColumnsAsItsRank) {
  std::mt19937_64 random(1);
  for (Eigen::Index size = 1; size <= 8; ++size) {
    for (Eigen::Index rank = 1; rank <= size; ++rank) {
      for (int trial = 0; trial < 20; ++trial) {
        const Eigen::MatrixXd covariance = random_covariance(random, size, rank);
        ASSERT_EQ(covariance_fault(covariance), "");
        const Eigen::MatrixXd factor = covariance_factor(covariance);
        EXPECT_EQ(factor.cols(), rank);
        const Eigen::VectorXd deviation = covariance.diagonal().cwiseSqrt();
        const Eigen::MatrixXd error = factor * factor.transpose() - covariance;
        for (Eigen::Index i = 0; i < size; ++i) {
          for (Eigen::Index j = 0; j < size; ++j) {
            // the rank test leaves out 2 n 64 eps
            EXPECT_LE(std::abs(error(i, j)), 3e-13 * deviation[i] * deviation[j]);
          }
        }
      }
    }
  }
}

// Full rank: nothing is left out, and only rounding remains.
TEST(CovarianceFactor, IsExactToRoundingAtFullRank) {
  Eigen::Matrix3d covariance;
  covariance << 4.0, 2.0, -0.6, 2.0, 9.0, 0.3, -0.6, 0.3, 0.25;
  const Eigen::MatrixXd factor = covariance_factor(covariance);
  EXPECT_LE((factor * factor.transpose() - covariance).cwiseAbs().maxCoeff(), 4e-15);
}

// Only the sum of two numbers is known well: with the draws of each the sum must scatter by its own
// small deviation, not by none.
TEST(CovarianceFactor, KeepsADirectionThatIsKnownFarBetterThanOthers) {
  constexpr double kSmall = 1e-10;  // variance of the sum
  Eigen::Matrix2d covariance;
  covariance << 1.0, -1.0 + 0.5 * kSmall, -1.0 + 0.5 * kSmall, 1.0;
  const Eigen::MatrixXd factor = covariance_factor(covariance);
  ASSERT_EQ(factor.cols(), 2);
  EXPECT_NEAR((factor.row(0) + factor.row(1)).squaredNorm() / kSmall, 1.0, 1e-5);
}

// Written with ten digits, with an eigenvalue below 0.
TEST(CovarianceFactor, LeavesOutWhatRoundedNumbersPutBelowZero) {
  Eigen::Matrix3d covariance;
  const double third = 0.33333333335;  // of 1/3: the matrix of rank 1 is not quite semi-definite
  covariance << 1.0, third, 1.0, third, third * third, third, 1.0, third, 1.0;
  covariance(1, 1) = 0.1111111111;
  ASSERT_EQ(covariance_fault(covariance), "");
  const Eigen::MatrixXd factor = covariance_factor(covariance);
  EXPECT_EQ(factor.cols(), 1);
  EXPECT_LE((factor * factor.transpose() - covariance).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(CovarianceFactor, HasNoColumnsWhereNothingScatters) {
  EXPECT_EQ(covariance_factor(Eigen::Matrix2d::Zero()).cols(), 0);
  Eigen::Matrix2d one;
  one << 0.0, 0.0, 0.0, 4.0;
  const Eigen::MatrixXd factor = covariance_factor(one);
  ASSERT_EQ(factor.cols(), 1);
  EXPECT_EQ(factor(0, 0), 0.0);
  EXPECT_EQ(factor(1, 0), 2.0);
}

TEST(CovarianceFactor, KeepsOppositeNumbersOnTheirLine) {
  Eigen::Matrix2d covariance;
  covariance << 4.0, -6.0, -6.0, 9.0;
  const Eigen::MatrixXd factor = covariance_factor(covariance);
  ASSERT_EQ(factor.cols(), 1);
  EXPECT_EQ(factor(0, 0), 2.0);
  EXPECT_EQ(factor(1, 0), -3.0);
}

TEST(CovarianceFault, DoesNotDependOnUnits) {
  Eigen::Matrix2d covariance;
  covariance << 1.0, 1.0001, 1.0001, 1.0;
  for (const double scale : {1e-9, 1.0, 1e9}) {
    const Eigen::Vector2d unit(scale, 1.0);
    EXPECT_NE(covariance_fault(unit.asDiagonal() * covariance * unit.asDiagonal()), "");
  }
  covariance << 1.0, 0.9999, 0.9999, 1.0;
  for (const double scale : {1e-9, 1.0, 1e9}) {
    const Eigen::Vector2d unit(scale, 1.0);
    EXPECT_EQ(covariance_fault(unit.asDiagonal() * covariance * unit.asDiagonal()), "");
  }
}

TEST(CovarianceFault, RefusesACorrelationWithWhatDoesNotScatter) {
  Eigen::Matrix2d covariance;
  covariance << 0.0, 0.1, 0.1, 1.0;
  EXPECT_EQ(covariance_fault(covariance),
            "must be positive semi-definite; [0][1] = 0.1 exceeds the product 0 of both standard "
            "deviations");
}

}  // namespace
}  // namespace servomill::sim::model::joint_normal_test
