#include "sim/identification/residual_colour.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>

namespace servomill::sim::identification::residual_colour_test {
namespace {

Eigen::VectorXd process(const std::vector<double>& a, Eigen::Index count, unsigned seed) {
  boost::random::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  Eigen::VectorXd e(count);
  for (Eigen::Index n = 0; n < count; ++n) {
    e[n] = normal(generator);
    for (std::size_t k = 0; k < a.size() && n > static_cast<Eigen::Index>(k); ++k) {
      e[n] -= a[k] * e[n - 1 - static_cast<Eigen::Index>(k)];
    }
  }
  return e;
}

TEST(ResidualColour, AutocovarianceIsTheMeanOfProducts) {
  const Eigen::Vector4d e(1.0, -2.0, 3.0, 0.5);
  const auto c = autocovariance(e, 2);
  EXPECT_DOUBLE_EQ(c[0], (1.0 + 4.0 + 9.0 + 0.25) / 4.0);
  EXPECT_DOUBLE_EQ(c[1], (-2.0 - 6.0 + 1.5) / 4.0);
  EXPECT_DOUBLE_EQ(c[2], (3.0 - 1.0) / 4.0);
}

TEST(ResidualColour, AnAutoregressiveProcessIsFoundFromItsOwnAutocovariances) {
  // e(n) = 0.9 e(n-1) + w: c(k) = 0.9^k / (1 - 0.81)
  std::vector<double> c;
  for (int k = 0; k < 12; ++k) c.push_back(std::pow(0.9, k) / 0.19);
  const AutoregressiveNoise noise = autoregressive(c, 100000);
  ASSERT_EQ(noise.a.size(), 1u);
  EXPECT_NEAR(noise.a[0], -0.9, 1e-12);
  EXPECT_NEAR(noise.innovation, 1.0, 1e-12);
  EXPECT_NEAR(noise.autocovariance[40], std::pow(0.9, 40) / 0.19, 1e-10) << "continued";
}

TEST(ResidualColour, EffectiveSamplesOfAFirstOrderProcess) {
  std::vector<double> c;
  for (int k = 0; k < 6; ++k) c.push_back(std::pow(0.9, k));
  // 1 + 2 sum 0.81^k = (1 + 0.81) / (1 - 0.81)
  EXPECT_NEAR(autoregressive(c, 10000).effective_samples(10000), 10000.0 * 0.19 / 1.81, 5.0);
  EXPECT_NEAR(autoregressive({1.0, 0.0, 0.0}, 10000).effective_samples(10000), 10000.0, 1e-9);
}

TEST(ResidualColour, TheOrderOfARecordedProcessIsFound) {
  const std::vector<double> a = {-1.6, 0.8};
  const Eigen::VectorXd e = process(a, 40000, 5);
  const AutoregressiveNoise noise = autoregressive(autocovariance(e, most_lags(40000)), 40000);
  ASSERT_GE(noise.a.size(), 2u);
  EXPECT_NEAR(noise.a[0], -1.6, 0.02);
  EXPECT_NEAR(noise.a[1], 0.8, 0.02);
  EXPECT_NEAR(noise.innovation, 1.0, 0.02);
}

TEST(ResidualColour, ColouringIsTheProductWithTheCovarianceMatrix) {
  AutoregressiveNoise noise;
  noise.autocovariance = {2.0, 1.0, 0.25};
  const Eigen::MatrixXd X = Eigen::MatrixXd::Random(7, 3);
  Eigen::MatrixXd Sigma = Eigen::MatrixXd::Zero(7, 7);
  for (Eigen::Index i = 0; i < 7; ++i) {
    for (Eigen::Index j = 0; j < 7; ++j) {
      const auto lag = static_cast<std::size_t>(std::abs(i - j));
      if (lag < 3) Sigma(i, j) = noise.autocovariance[lag];
    }
  }
  EXPECT_TRUE(coloured(noise, X).isApprox(Sigma * X, 1e-12));
}

TEST(ResidualColour, CrossSumsAreTheDiagonalsOfTheirProducts) {
  const Eigen::MatrixXd U = Eigen::MatrixXd::Random(9, 2), V = Eigen::MatrixXd::Random(9, 2);
  const Eigen::MatrixXd both = U * V.transpose() + V * U.transpose();
  const auto sums = cross_sums(U, V, 4);
  for (std::size_t lag = 0; lag <= 4; ++lag) {
    EXPECT_NEAR(sums[lag], both.diagonal(static_cast<Eigen::Index>(lag)).sum(), 1e-12) << lag;
  }
}

}  // namespace
}  // namespace servomill::sim::identification::residual_colour_test
