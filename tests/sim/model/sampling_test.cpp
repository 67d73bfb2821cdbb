#include "sim/model/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace servomill::sim::model::sampling_test {
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

TEST_P(EverySampling, HasTheMomentsOfIndependentUniformNumbers) {
  constexpr std::uint64_t kMany = 4096;
  const double n = kMany;
  // five standard errors of independent samples
  const double kMeanTol = 5.0 * std::sqrt(1.0 / 12.0 / n);
  const double kVarianceTol = 5.0 * std::sqrt(1.0 / 180.0 / n);
  const double kCorrelationTol = 5.0 / std::sqrt(n);
  std::array<double, kDimensions> mean{}, variance{};
  std::array<std::array<double, kDimensions>, kDimensions> correlation{};
  for (std::uint64_t i = 0; i < kMany; ++i) {
    const auto x = unit_sample(settings(3, kMany), i, kDimensions);
    for (std::size_t a = 0; a < kDimensions; ++a) {
      mean[a] += x[a] / n;
      variance[a] += (x[a] - 0.5) * (x[a] - 0.5) / n;
      for (std::size_t b = 0; b < a; ++b) {
        correlation[a][b] += 12.0 * (x[a] - 0.5) * (x[b] - 0.5) / n;
      }
    }
  }
  for (std::size_t a = 0; a < kDimensions; ++a) {
    EXPECT_NEAR(mean[a], 0.5, kMeanTol);
    EXPECT_NEAR(variance[a], 1.0 / 12.0, kVarianceTol);
    for (std::size_t b = 0; b < a; ++b) EXPECT_NEAR(correlation[a][b], 0.0, kCorrelationTol);
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
}  // namespace servomill::sim::model::sampling_test
