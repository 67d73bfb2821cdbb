#include "sim/responses/period_response.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <numbers>

#include "tests/text.h"

namespace servomill::sim::responses::period_response_test {
namespace {

constexpr std::size_t kSamples = 200;

// y(n) = 0.5 y(n-1) + u(n-1): G = z^-1 / (1 - 0.5 z^-1)
Complex truth(std::size_t line) {
  const Complex z = std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(line) / kSamples);
  return z / (1.0 - 0.5 * z);
}

struct Signals {
  std::vector<double> u, y;
};

// Lines 3 to 40, phases after Schroeder.
Signals measured(std::size_t periods, double noise, unsigned seed) {
  boost::random::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  Signals s;
  double y = 0.0, last = 0.0;
  for (std::size_t n = 0; n < periods * kSamples; ++n) {
    double u = 0.0;
    for (int k = 3; k <= 40; ++k) {
      u += std::cos(2.0 * std::numbers::pi * k * static_cast<double>(n) / kSamples -
                    std::numbers::pi * k * k / 38.0);
    }
    y = 0.5 * y + last;
    last = u;
    s.u.push_back(u + 0.5 * noise * normal(generator));
    s.y.push_back(y + noise * normal(generator));
  }
  return s;
}

const PeriodSettings kSettings{.samples = kSamples, .skip = 1, .rate = 1000.0};

TEST(PeriodResponse, WithoutNoiseItIsTheSystemAndItsVarianceNothing) {
  const Signals s = measured(4, 0.0, 1);
  const MeasuredResponse found = maximum_likelihood(s.u, s.y, kSettings, "x");
  ASSERT_EQ(found.lines.size(), 38u);
  EXPECT_EQ(found.periods, 3u);
  EXPECT_EQ(found.unexcited, 0u);
  for (std::size_t k = 0; k < found.lines.size(); ++k) {
    EXPECT_DOUBLE_EQ(found.lines[k].frequency, 5.0 * static_cast<double>(k + 3));
    EXPECT_NEAR(std::abs(found.lines[k].value - truth(k + 3)), 0.0, 1e-12);
    EXPECT_LT(found.lines[k].variance, 1e-25);
  }
}

TEST(PeriodResponse, TheTransientIsInTheFirstPeriodOnly) {
  const Signals s = measured(4, 0.0, 1);
  PeriodSettings all = kSettings;
  all.skip = 0;
  const MeasuredResponse with = maximum_likelihood(s.u, s.y, all, "x");
  EXPECT_GT(std::abs(with.lines[0].value - truth(3)), 1e-5);
}

TEST(PeriodResponse, CirclesHoldTheTruthAsOftenAsTheyClaim) {
  int inside = 0, all = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const Signals s = measured(7, 0.8, seed);
    const MeasuredResponse found = maximum_likelihood(s.u, s.y, kSettings, "x");
    for (std::size_t k = 0; k < found.lines.size(); ++k) {
      inside += std::abs(found.lines[k].value - truth(k + 3)) <= found.lines[k].radius_95 ? 1 : 0;
      ++all;
    }
  }
  EXPECT_NEAR(static_cast<double>(inside) / all, 0.95, 0.01);
}

TEST(PeriodResponse, RefusesTooFewPeriodsAndNoExcitation) {
  const Signals s = measured(2, 0.0, 1);
  EXPECT_EQ(fault_messages([&] { maximum_likelihood(s.u, s.y, kSettings, "x"); }),
            "has 2 full periods of 200 samples; at least 3 are required: two after the 1 skipped "
            "for the transient\n");
  const std::vector<double> still(4 * kSamples, 0.5);
  EXPECT_EQ(fault_messages([&] { maximum_likelihood(still, still, kSettings, "x"); }),
            "has an input without excitation\n");
}

TEST(PeriodResponse, ExtremesAreRefinedBetweenLines) {
  MeasuredResponse response;
  for (int k = 0; k <= 100; ++k) {
    const double f = k;
    response.lines.push_back(
        {.frequency = f, .value = std::exp(-std::pow((f - 40.3) / 5.0, 2)) + 0.1});
  }
  const std::vector<Extreme> found = extremes(response);
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(found.front().is_maximum);
  EXPECT_NEAR(found.front().frequency, 40.3, 0.05);
}

}  // namespace
}  // namespace servomill::sim::responses::period_response_test
