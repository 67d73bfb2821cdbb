#include "sim/limits/mean_derivative.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace servomill::sim::limits::mean_derivative_test {
namespace {

// Instants that are not evenly spaced.
std::vector<double> instants(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> step(0.5e-3, 1.5e-3);
  std::vector<double> t = {0.0};
  while (t.size() < count) t.push_back(t.back() + step(random));
  return t;
}

template <class F>
std::vector<double> sampled(const std::vector<double>& t, F f) {
  std::vector<double> x;
  for (const double time : t) x.push_back(f(time));
  return x;
}

TEST(MeanDerivative, OfAPowerIsItsFactorial) {
  const std::vector<double> t = instants(40, 1);
  const double factorial[] = {1.0, 1.0, 2.0, 6.0};
  for (int n = 1; n <= kMaxOrder; ++n) {
    const std::vector<double> x = sampled(t, [n](double time) { return std::pow(time, n); });
    for (const std::size_t step : {1u, 3u, 10u}) {
      const double wanted = factorial[n];
      EXPECT_NEAR(mean_derivative(t, x, n, step, 5, 0.0).value, wanted, 1e-6 * wanted) << n << step;
    }
  }
}

TEST(MeanDerivative, OfOrderZeroIsTheSample) {
  const std::vector<double> t = {0.0, 1.0}, x = {3.0, -4.5};
  const MeanDerivative mean = mean_derivative(t, x, 0, 1, 1, 0.5);
  EXPECT_EQ(mean.value, -4.5);
  EXPECT_EQ(mean.floor, 0.25);
  EXPECT_EQ(mean.time, 1.0);
}

TEST(MeanDerivative, IsOfTheMiddleOfItsWindow) {
  const std::vector<double> t = {0.0, 1.0, 2.0, 4.0, 8.0}, x(5, 0.0);
  EXPECT_EQ(mean_derivative(t, x, 2, 2, 0, 0.0).time, 4.0);
  EXPECT_EQ(mean_derivative(t, x, 1, 1, 2, 0.0).time, 3.0);
}

// Law: no mean is beyond the largest value of the derivative, at any sampling.
TEST(MeanDerivative, IsNeverBeyondTheDerivative) {
  const double A = 0.01, w = 300.0;  // m, rad/s
  const double largest[] = {0.0, A * w, A * w * w, A * w * w * w};
  const std::vector<double> t = instants(2000, 2);
  const std::vector<double> x = sampled(t, [&](double time) { return A * std::sin(w * time); });
  for (int n = 1; n <= kMaxOrder; ++n) {
    double found = 0.0;
    for (std::size_t k = 0; k + static_cast<std::size_t>(n) < t.size(); ++k) {
      found = std::max(found, std::abs(mean_derivative(t, x, n, 1, k, 0.0).value));
    }
    EXPECT_LE(found, largest[n] * (1.0 + 1e-9)) << n;
    EXPECT_GT(found, 0.95 * largest[n]) << n;
  }
}

// Law: rounding of the samples changes a mean by its floor at most.
TEST(MeanDerivative, IsChangedByResolutionWithinItsFloor) {
  const double q = 1e-6;
  const std::vector<double> t = instants(3000, 3);
  const std::vector<double> x =
      sampled(t, [](double time) { return 0.02 * std::sin(40.0 * time); });
  std::vector<double> rounded;
  for (const double value : x) rounded.push_back(q * std::round(value / q));
  for (int n = 1; n <= kMaxOrder; ++n) {
    double worst = 0.0;  // share of the floor
    for (std::size_t k = 0; k + 4 * static_cast<std::size_t>(n) < t.size(); ++k) {
      const MeanDerivative exact = mean_derivative(t, x, n, 4, k, 0.0);
      const MeanDerivative coarse = mean_derivative(t, rounded, n, 4, k, q);
      worst = std::max(worst, std::abs(coarse.value - exact.value) / coarse.floor);
    }
    EXPECT_LE(worst, 1.0 + 1e-6) << n;
    EXPECT_GT(worst, 0.5) << n;  // the bound is no idle one
  }
}

TEST(Quantum, OfPrintedDecimalsIsTheLastOfThem) {
  std::vector<double> x;
  for (int k = 0; k < 1000; ++k) x.push_back(std::round(1e5 * 100.0 * std::sin(0.01 * k)) / 1e5);
  EXPECT_DOUBLE_EQ(quantum_of(x), 1e-5);
}

TEST(Quantum, OfAnEncoderIsItsStep) {
  const double q = 20.0 / 4096.0;  // mm
  std::vector<double> x;
  for (int k = 0; k < 1000; ++k) x.push_back(q * std::round(50.0 * std::sin(0.01 * k) / q));
  EXPECT_NEAR(quantum_of(x), q, 1e-12);
}

// No two samples differ by one step alone.
TEST(Quantum, OfBinaryRoundingIsItsPowerOfTwo) {
  const double q = std::ldexp(1.0, -28);
  std::vector<double> x;
  for (int k = 0; k < 1000; ++k)
    x.push_back(q * std::round((80.0 + 20.0 * std::sin(5e-4 * k)) / q));
  EXPECT_EQ(quantum_of(x), q);
}

TEST(Quantum, OfAMotionInEqualStepsIsNotThoseSteps) {
  std::vector<double> even, accelerated;
  for (int k = 0; k < 300; ++k) even.push_back(0.25 * k);
  for (int k = 0; k < 300; ++k) accelerated.push_back(0.5 * k * k);
  EXPECT_LT(quantum_of(even), 1e-12);
  EXPECT_LT(quantum_of(accelerated), 1e-10);
}

TEST(Quantum, OfDoublesIsTheirRounding) {
  std::vector<double> x;
  for (int k = 0; k < 1000; ++k) x.push_back(std::sin(0.01 * k));
  EXPECT_LT(quantum_of(x), 1e-14);
  EXPECT_GT(quantum_of(x), 0.0);
}

TEST(Quantum, OfAChannelAtRestIsItsRounding) {
  EXPECT_LT(quantum_of(std::vector<double>(10, 3.25)), 1e-14);
}

}  // namespace
}  // namespace servomill::sim::limits::mean_derivative_test
