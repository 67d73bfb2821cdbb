/// Conformity of sampled quantities with their tolerances.
#include "sim/sweep/conformity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sim/model/sampling.h"

namespace servomill::sim::sweep::conformity_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Quantiles of the normal distribution at equal steps of probability.
std::vector<double> normal_values(int count, double mean, double deviation) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) {
    out.push_back(mean + deviation * model::normal_quantile((i + 0.5) / count));
  }
  return out;
}

// Within +-2 of a mean 1 and a deviation 0.8: Phi(1.25) - Phi(-3.75) = 0.894262.
TEST(Conformity, OfNormalValuesIsThatOfTheirDistribution) {
  const Conformity found = conformity_of(normal_values(10000, 1.0, 0.8), {-2.0, 2.0});
  const auto Phi = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
  EXPECT_NEAR(found.probability, Phi(1.25) - Phi(-3.75), 1e-4);  // one value
  EXPECT_NEAR(found.guard_band, 1.65 * 0.8, 1e-3);               // of 10^4 quantiles
  EXPECT_EQ(found.statement, Statement::neither);
}

// A value that far inside one limit lies within it with a probability of 95 %.
TEST(GuardBand, LeavesFivePercentBeyondALimit) {
  const auto values = normal_values(10000, 10.0 - kGuardFactor, 1.0);
  const double inside = conformity_of(values, {-100.0, 10.0}).probability;
  EXPECT_NEAR(inside, 0.95, 0.001);  // the factor is rounded to three digits
}

// scipy.stats.binomtest(k, n).proportion_ci(method="wilson")
TEST(Conformity, HasTheIntervalOfWilson) {
  std::vector<double> values(38, 0.0);
  values.insert(values.end(), 2, 5.0);
  const Conformity found = conformity_of(values, {-1.0, 1.0});
  EXPECT_DOUBLE_EQ(found.probability, 0.95);
  EXPECT_NEAR(found.low, 0.8349612, 1e-7);
  EXPECT_NEAR(found.high, 0.9861793, 1e-7);
}

// 72 / (72 + 1.96^2) = 0.9493, 73 / (73 + 1.96^2) = 0.9500
TEST(Conformity, IsProvenBySeventyThreeSamplesInside) {
  const model::Tolerance limits{-1.0, 1.0};
  EXPECT_EQ(conformity_of(std::vector<double>(72, 1.0), limits).statement, Statement::neither);
  EXPECT_EQ(conformity_of(std::vector<double>(73, 1.0), limits).statement, Statement::conforms);
  EXPECT_EQ(conformity_of(std::vector<double>(72, 1.1), limits).statement, Statement::neither);
  EXPECT_EQ(conformity_of(std::vector<double>(73, 1.1), limits).statement,
            Statement::does_not_conform);
}

TEST(Conformity, LooksAtPointsWithAValueOnly) {
  EXPECT_EQ(conformity_of(std::vector<double>{kNaN, 0.0, 3.0, kNaN}, {-1.0, 1.0}).probability, 0.5);
  const Conformity none = conformity_of(std::vector<double>{kNaN}, {-1.0, 1.0});
  EXPECT_TRUE(std::isnan(none.probability));
  EXPECT_EQ(none.statement, Statement::neither);
}

}  // namespace
}  // namespace servomill::sim::sweep::conformity_test
