/// Repetitions of a virtual CMM.
#include "sim/metrology/cmm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "plant/vocabulary/units.h"

namespace servomill::sim::metrology::cmm_test {
namespace {

constexpr int kMany = 10000;
// of the standard deviation of kMany normal numbers: 1 / sqrt(2 kMany) = 0.7 %
constexpr double kFourSigma = 4.0 / 141.4;

Cmm cmm_of(int repetitions, std::uint64_t seed = 1) {
  Cmm cmm;
  cmm.uncertainty = 1.5 * um;
  cmm.repetitions = repetitions;
  cmm.seed = seed;
  return cmm;
}

// Fraction of products of standard scores: 0 +- 1 / sqrt(kMany) where there is no correlation.
double correlation(const std::vector<double>& a, const std::vector<double>& b, double sigma) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum / (sigma * sigma * static_cast<double>(a.size()));
}

TEST(Cmm, SpreadsByHalfItsUncertainty) {
  const std::vector<double> d = {3 * um, -2 * um};
  const auto measured = probe_all(cmm_of(kMany), "one", "flank", d);
  const double sigma = 0.75 * um;
  for (std::size_t i = 0; i < d.size(); ++i) {
    EXPECT_NEAR(standard_deviation_of(measured)[i], sigma, kFourSigma * sigma);
    EXPECT_NEAR(mean_of(measured)[i], d[i], 4.0 * sigma / std::sqrt(kMany));
  }
}

TEST(Cmm, ErrsIndependentlyAtPointsInFeaturesCasesAndForSeeds) {
  const std::vector<double> d(kMany, 0.0);
  const auto errors = [&](std::uint64_t seed, const char* one, const char* feature,
                          int repetition) {
    return probe_once(cmm_of(1, seed), one, feature, d, repetition);
  };
  const std::vector<double> first = errors(1, "one", "flank", 0);
  EXPECT_EQ(first, errors(1, "one", "flank", 0));
  std::vector<double> shifted = first;
  std::rotate(shifted.begin(), shifted.begin() + 1, shifted.end());
  for (const auto& other : {errors(2, "one", "flank", 0), errors(1, "two", "flank", 0),
                            errors(1, "one", "plane", 0), errors(1, "one", "flank", 1), shifted}) {
    EXPECT_LT(std::abs(correlation(first, other, 0.75 * um)), 4.0 / std::sqrt(kMany));
  }
}

TEST(Cmm, WithoutUncertaintyMeasuresWhatIsThereAndLeavesMissedPointsOut) {
  const std::vector<double> d = {1 * um, std::numeric_limits<double>::quiet_NaN()};
  Cmm cmm = cmm_of(1);
  cmm.uncertainty = 0.0;
  const auto measured = probe_all(cmm, "one", "flank", d);
  ASSERT_EQ(measured.size(), 1U);
  EXPECT_EQ(measured[0][0], d[0]);
  EXPECT_TRUE(std::isnan(measured[0][1]));
  EXPECT_EQ(standard_deviation_of(measured)[0], 0.0);
}

}  // namespace
}  // namespace servomill::sim::metrology::cmm_test
