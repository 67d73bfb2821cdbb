#include "sim/responses/rational_fit.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <numbers>

#include "tests/text.h"

namespace servomill::sim::responses::rational_fit_test {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

Complex pair(Complex s, double f, double damping) {
  const double w = kTurn * f;
  return (s * s + 2.0 * damping * w * s + w * w) / (w * w);
}

// Antiresonance 54 Hz, resonance 76 Hz, a pole at 3 Hz, 2 ms.
Complex truth(double f) {
  const Complex s(0.0, kTurn * f);
  return 7e-4 * pair(s, 54.0, 0.03) / (pair(s, 76.0, 0.02) * (1.0 + s / (kTurn * 3.0))) *
         std::exp(-0.002 * s);
}

MeasuredResponse measured(double noise, unsigned seed) {
  boost::random::mt19937 generator(seed);
  boost::random::normal_distribution<double> normal;
  MeasuredResponse out;
  out.periods = 10;
  for (double f = 10.0; f <= 150.0; f += 0.5) {
    ResponseLine line;
    line.frequency = f;
    const double deviation = noise * std::abs(truth(f));
    line.variance = deviation * deviation;
    line.value =
        truth(f) + deviation / std::sqrt(2.0) * Complex(normal(generator), normal(generator));
    out.lines.push_back(line);
  }
  return out;
}

constexpr RationalOrder kOrder{2, 3, true};

TEST(RationalFit, FindsPolesZerosAndDeadTime) {
  const RationalFit fit = fit_rational(measured(1e-6, 1), kOrder, "a.csv");
  ASSERT_EQ(fit.zeros.size(), 1u);
  ASSERT_EQ(fit.poles.size(), 2u);
  EXPECT_NEAR(fit.zeros[0].frequency, 54.0, 1e-3);
  EXPECT_NEAR(fit.zeros[0].damping, 0.03, 1e-5);
  EXPECT_NEAR(fit.poles[0].frequency, 3.0, 1e-3);
  EXPECT_FALSE(fit.poles[0].is_pair);
  EXPECT_NEAR(fit.poles[1].frequency, 76.0, 1e-3);
  EXPECT_NEAR(fit.poles[1].damping, 0.02, 1e-5);
  EXPECT_NEAR(fit.model.dead_time, 0.002, 1e-6);
}

// The weights are right: values scatter as the covariance says.
TEST(RationalFit, ItsIntervalsHoldTheTruth) {
  int inside = 0;
  constexpr int kFits = 100;
  for (unsigned seed = 1; seed <= kFits; ++seed) {
    const RationalFit fit = fit_rational(measured(0.02, seed), kOrder, "a.csv");
    ASSERT_EQ(fit.poles.size(), 2u);
    EXPECT_NEAR(fit.noise_ratio, 1.0, 0.2);
    inside += std::abs(fit.zeros[0].frequency - 54.0) < 1.96 * fit.zeros[0].frequency_deviation;
    inside += std::abs(fit.poles[1].frequency - 76.0) < 1.96 * fit.poles[1].frequency_deviation;
    inside += std::abs(fit.poles[1].damping - 0.02) < 1.96 * fit.poles[1].damping_deviation;
    inside += std::abs(fit.model.dead_time - 0.002) < 1.96 * fit.dead_time_deviation;
  }
  EXPECT_NEAR(inside / (4.0 * kFits), 0.95, 0.03);
}

TEST(RationalFit, NamesAnOrderThatIsTooLow) {
  const RationalFit fit = fit_rational(measured(0.001, 1), {0, 1, false}, "a.csv");
  EXPECT_TRUE(fit.has_model_error());
  EXPECT_GT(fit.poles[0].frequency_deviation,
            10.0 * fit_rational(measured(0.001, 1), kOrder, "a.csv").poles[1].frequency_deviation);
}

TEST(RationalFit, RefusesMoreParametersThanLines) {
  MeasuredResponse few = measured(0.01, 1);
  few.lines.resize(4);
  EXPECT_EQ(fault_messages([&] { fit_rational(few, kOrder, "a.csv"); }),
            "contains 4 lines; 7 of a numerator of degree 2 and a denominator of degree 3 require "
            "at least as many\n");
}

}  // namespace
}  // namespace servomill::sim::responses::rational_fit_test
