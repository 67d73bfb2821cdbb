#include "sim/sweep/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace servomill::sim {
namespace {

constexpr std::size_t kDimensions = 5;
constexpr std::uint64_t kCount = 256;

class EverySampling : public testing::TestWithParam<Sampling> {
 protected:
  static SampleSettings settings(std::uint64_t seed = 1, std::uint64_t count = kCount) {
    return {GetParam(), count, seed};
  }
  // One coordinate of all samples.
  static std::vector<double> column(const SampleSettings& all, std::size_t dimension) {
    std::vector<double> out;
    for (std::uint64_t i = 0; i < all.count; ++i) {
      out.push_back(unit_sample(all, i, kDimensions)[dimension]);
    }
    return out;
  }
};

INSTANTIATE_TEST_SUITE_P(All, EverySampling,
                         testing::Values(Sampling::random, Sampling::latin_hypercube,
                                         Sampling::sobol));

TEST_P(EverySampling, StaysWithinTheOpenUnitCube) {
  for (std::size_t d = 0; d < kDimensions; ++d) {
    for (const double x : column(settings(), d)) {
      EXPECT_GT(x, 0.0);
      EXPECT_LT(x, 1.0);
    }
  }
}

TEST_P(EverySampling, GivesTheSameNumbersWhateverWasAskedBefore) {
  const auto alone = unit_sample(settings(), 137, kDimensions);
  for (std::uint64_t i = kCount; i-- > 0;) unit_sample(settings(), i, kDimensions);
  EXPECT_EQ(unit_sample(settings(), 137, kDimensions), alone);
}

TEST_P(EverySampling, GivesOtherNumbersForAnotherSeed) {
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const auto one = unit_sample(settings(1), i, kDimensions);
    const auto other = unit_sample(settings(2), i, kDimensions);
    for (std::size_t d = 0; d < kDimensions; ++d) EXPECT_NE(one[d], other[d]) << i << ' ' << d;
  }
}

TEST_P(EverySampling, HasTheMeanAndTheVarianceOfTheUniformDistribution) {
  constexpr std::uint64_t kMany = 4096;
  // five standard errors of independent samples: sqrt(1/12/n); the kurtosis gives sqrt(1/180/n)
  const double kMeanTol = 5.0 * std::sqrt(1.0 / 12.0 / kMany);
  const double kVarianceTol = 5.0 * std::sqrt(1.0 / 180.0 / kMany);
  for (std::size_t d = 0; d < kDimensions; ++d) {
    const auto x = column(settings(3, kMany), d);
    const double mean = std::accumulate(x.begin(), x.end(), 0.0) / kMany;
    double variance = 0.0;
    for (const double one : x) variance += (one - mean) * (one - mean) / kMany;
    EXPECT_NEAR(mean, 0.5, kMeanTol);
    EXPECT_NEAR(variance, 1.0 / 12.0, kVarianceTol);
  }
}

TEST_P(EverySampling, HasDimensionsThatDoNotCorrelate) {
  constexpr std::uint64_t kMany = 4096;
  const double kCorrelationTol =
      5.0 / std::sqrt(static_cast<double>(kMany));  // five standard errors
  for (std::size_t a = 0; a < kDimensions; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const auto x = column(settings(4, kMany), a), y = column(settings(4, kMany), b);
      double sum = 0.0;
      for (std::size_t i = 0; i < kMany; ++i) sum += 12.0 * (x[i] - 0.5) * (y[i] - 0.5);
      EXPECT_NEAR(sum / kMany, 0.0, kCorrelationTol) << a << ' ' << b;
    }
  }
}

// Each of `count` equal intervals holds one of the numbers.
void expect_stratified(const std::vector<double>& x) {
  const auto count = static_cast<double>(x.size());
  std::set<double> intervals;
  for (const double one : x) intervals.insert(std::floor(one * count));
  EXPECT_EQ(intervals.size(), x.size());
}

class LatinHypercube : public EverySampling {};
INSTANTIATE_TEST_SUITE_P(One, LatinHypercube, testing::Values(Sampling::latin_hypercube));

TEST_P(LatinHypercube, HasOneSampleInEachInterval) {
  for (const std::uint64_t count : {1U, 2U, 3U, 10U, 255U, 256U, 257U, 1000U}) {
    for (std::size_t d = 0; d < kDimensions; ++d) expect_stratified(column(settings(9, count), d));
  }
}

TEST_P(LatinHypercube, KeepsADimensionWhenOthersAreAdded) {
  const auto few = unit_sample(settings(), 17, 2), many = unit_sample(settings(), 17, kDimensions);
  EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
}

class Sobol : public EverySampling {};
INSTANTIATE_TEST_SUITE_P(One, Sobol, testing::Values(Sampling::sobol));

TEST_P(Sobol, HasOneSampleInEachIntervalOfAnyPowerOfTwo) {
  for (std::uint64_t count = 1; count <= 1024; count *= 2) {
    for (std::size_t d = 0; d < kDimensions; ++d) expect_stratified(column(settings(9, count), d));
  }
}

// The first two dimensions are a (0, m, 2)-net: one sample in each box of any shape of area 2^-m.
TEST_P(Sobol, FillsBoxesOfTheFirstTwoDimensions) {
  constexpr unsigned kBits = 8;
  const auto x = column(settings(5), 0), y = column(settings(5), 1);
  for (unsigned a = 0; a <= kBits; ++a) {
    std::set<std::pair<double, double>> boxes;
    for (std::size_t i = 0; i < kCount; ++i) {
      boxes.emplace(std::floor(x[i] * std::exp2(a)), std::floor(y[i] * std::exp2(kBits - a)));
    }
    EXPECT_EQ(boxes.size(), kCount) << a;
  }
}

TEST(Permuted, TakesEachPlaceOnce) {
  for (const std::uint64_t count : {1U, 2U, 5U, 64U, 1000U}) {
    std::set<std::uint64_t> places;
    for (std::uint64_t i = 0; i < count; ++i) places.insert(permuted(i, count, 42));
    EXPECT_EQ(places.size(), count);
    EXPECT_EQ(*places.rbegin(), count - 1);
  }
}

TEST(Permuted, DependsOnItsKey) {
  std::size_t same = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) same += permuted(i, 1000, 1) == permuted(i, 1000, 2);
  EXPECT_LT(same, 10U);  // one is expected; ten have a probability of 1e-7
}

TEST(NormalQuantile, IsThatOfTables) {
  constexpr double kTableTol = 5e-7;  // tables have six decimals
  EXPECT_NEAR(normal_quantile(0.5), 0.0, 1e-15);
  EXPECT_NEAR(normal_quantile(0.841344746), 1.0, kTableTol);
  EXPECT_NEAR(normal_quantile(0.975), 1.959964, kTableTol);
  EXPECT_NEAR(normal_quantile(0.001), -3.090232, kTableTol);
}

}  // namespace
}  // namespace servomill::sim
