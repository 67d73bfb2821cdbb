#include "plant/geometry/error_function.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::error_function_test {
namespace {

constexpr double kStep = 1e-4;  // m, of the central differences

// Largest difference between derivative and central difference over [-1, 1], off the points s.
double derivative_miss(const ErrorFunction& f) {
  double miss = 0.0;
  for (int i = -99; i <= 99; ++i) {
    const double s = i / 99.3;  // never within kStep of a tenth
    const double difference = (f.value(s + kStep) - f.value(s - kStep)) / (2.0 * kStep);
    miss = std::max(miss, std::abs(difference - f.derivative(s)));
  }
  return miss;
}

TEST(ErrorFunction, ConstantIsTheSameEverywhere) {
  EXPECT_EQ(constant(3e-6).value(-7.0), 3e-6);
  EXPECT_EQ(constant(3e-6).derivative(5.0), 0.0);
}

TEST(ErrorFunction, OverSeveralAxesHasNoValueOverItsOwnAlone) {
  const ErrorFunction f = grid({{Axis::X, Axis::Z}, {{0.0, 1.0}, {0.0, 1.0}}, {0, 0, 1e-6, 2e-6}});
  EXPECT_THROW(f.value(0.5), std::logic_error);
  EXPECT_THROW(f.derivative(0.5), std::logic_error);
  EXPECT_EQ(f.value(0.5, AxisWords::Zero()), 0.0);
}

TEST(ErrorFunction, PolynomialCountsFromTheConstantTermUp) {
  const ErrorFunction f = polynomial({1.0, -2.0, 0.5, 4.0});
  EXPECT_EQ(f.value(0.5), 1.0 - 1.0 + 0.125 + 0.5);
  EXPECT_EQ(f.derivative(0.5), -2.0 + 0.5 + 3.0);
}

TEST(ErrorFunction, HarmonicOfTheFirstExperimentHasItsSteepestSlopeAtTheCrossings) {
  const ErrorFunction f = harmonic(150 * um, 62 * mm);
  EXPECT_EQ(f.value(0.0), 0.0);
  EXPECT_DOUBLE_EQ(f.value(15.5 * mm), 150 * um);
  EXPECT_DOUBLE_EQ(f.derivative(0.0), 2.0 * std::numbers::pi * 150 * um / (62 * mm));
  EXPECT_DOUBLE_EQ(harmonic(150 * um, 62 * mm, 90 * deg).value(0.0), 150 * um);
}

TEST(ErrorFunction, TableIsLinearBetweenItsPointsAndConstantBeyond) {
  const ErrorFunction f = linear_table({-1.0, 0.0, 0.5}, {2.0, 4.0, 3.0});
  EXPECT_EQ(f.value(-5.0), 2.0);
  EXPECT_EQ(f.value(-1.0), 2.0);
  EXPECT_EQ(f.value(-0.25), 3.5);
  EXPECT_EQ(f.value(0.0), 4.0);
  EXPECT_EQ(f.value(0.25), 3.5);
  EXPECT_EQ(f.value(0.5), 3.0);
  EXPECT_EQ(f.value(9.0), 3.0);
}

TEST(ErrorFunction, SlopeOfATableIsThatOfTheIntervalAndZeroBeyond) {
  const ErrorFunction f = linear_table({-1.0, 0.0, 0.5}, {2.0, 4.0, 3.0});
  EXPECT_EQ(f.derivative(-1.01), 0.0);
  EXPECT_EQ(f.derivative(-1.0), 2.0);
  EXPECT_EQ(f.derivative(-0.01), 2.0);
  EXPECT_EQ(f.derivative(0.0), -2.0);
  EXPECT_EQ(f.derivative(0.5), 0.0);
}

TEST(ErrorFunction, TableOfOnePointIsConstant) {
  const ErrorFunction f = linear_table({0.2}, {5.0});
  for (const double s : {-1.0, 0.2, 1.0}) {
    EXPECT_EQ(f.value(s), 5.0);
    EXPECT_EQ(f.derivative(s), 0.0);
  }
}

TEST(ErrorFunction, DerivativeIsTheLimitOfCentralDifferences) {
  // third derivative of the polynomial: 24 x 0.7; of the harmonic: (2 pi / 0.5)^3
  EXPECT_LT(derivative_miss(polynomial({1.0, 2.0, -3.0, 4.0, 0.7})),
            kStep * kStep / 6.0 * (24.0 + 24.0 * 0.7) + 1e-11);
  EXPECT_LT(derivative_miss(harmonic(1.0, 0.5, 0.3)),
            kStep * kStep / 6.0 * std::pow(4.0 * std::numbers::pi, 3) + 1e-11);
  const ErrorFunction table = linear_table({-0.5, 0.1, 0.6}, {0.3, -0.2, 0.9});
  EXPECT_LT(derivative_miss(table), 1e-11);  // rounding 1e-16 over 2e-4
}

TEST(ErrorFunction, SumsAddValuesAndDerivatives) {
  Uniform random(3);
  const ErrorFunction f = polynomial({1.0, 2.0}) + linear_table({0.0, 1.0}, {0.0, 1.0});
  const ErrorFunction g = polynomial({1.0, 2.0, 3.0}) + harmonic(1.0, 0.7);
  for (int i = 0; i < 100; ++i) {
    const double s = 2.0 * random();
    EXPECT_NEAR((f + g).value(s), f.value(s) + g.value(s), 1e-13);  // rounding of ~ 20
    EXPECT_NEAR((g + f).derivative(s), f.derivative(s) + g.derivative(s), 1e-13);
    EXPECT_NEAR(scaled(f + g, -0.5).value(s), -0.5 * (f.value(s) + g.value(s)), 1e-13);
  }
}

TEST(ErrorFunction, IsZeroOnlyIfAllItsNumbersAre) {
  EXPECT_TRUE(ErrorFunction().is_zero());
  EXPECT_EQ(ErrorFunction().value(0.7), 0.0);
  EXPECT_TRUE((polynomial({0.0, 0.0}) + harmonic(0.0, 1.0) + linear_table({0.0}, {0.0})).is_zero());
  EXPECT_TRUE(scaled(harmonic(1.0, 1.0), 0.0).is_zero());
  EXPECT_FALSE(polynomial({0.0, 1e-300}).is_zero());
  EXPECT_FALSE(harmonic(1e-300, 1.0).is_zero());
  EXPECT_FALSE(linear_table({0.0, 1.0}, {0.0, 1e-300}).is_zero());
}

TEST(ErrorFunction, FaultsOfATableAreNamed) {
  EXPECT_EQ(table_fault({0.0, 1.0}, {0.0, 1.0}), std::nullopt);
  EXPECT_EQ(table_fault({}, {}), "has no points; must have at least 1");
  EXPECT_EQ(table_fault({0.0, 1.0}, {0.0}),
            "has 2 positions and 1 errors; the numbers must be equal");
  EXPECT_EQ(table_fault({0.0, 0.5, 0.5}, {0.0, 1.0, 2.0}),
            "0.5 follows 0.5 at point 3; positions must increase");
  EXPECT_EQ(table_fault({0.0, 1.0}, {0.0, std::numeric_limits<double>::infinity()}),
            "has (1, inf) at point 2; must be finite");
}

}  // namespace
}  // namespace servomill::plant::error_function_test
