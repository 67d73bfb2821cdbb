#include "controllers/path/nominal_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::nominal_filter_test {
namespace {

constexpr double kRounding = 1e-15;  // m, rounding of sums of 0.1 m
constexpr double kCycle = 1.8 * ms;

Joints at(double x, double y) {
  Joints Q = Joints::Zero();
  Q[0] = x;
  Q[1] = y;
  return Q;
}

TEST(NominalFilter, StandsStillWhereItStarted) {
  NominalFilter filter(FilterShape::triangle, 20, at(0.1, -0.3));
  for (int k = 0; k < 1000; ++k) {
    EXPECT_LE((filter(at(0.1, -0.3)) - at(0.1, -0.3)).norm(), kRounding);
  }
}

TEST(NominalFilter, AnswersAStepWithARampOfItsLength) {
  NominalFilter filter(FilterShape::mean, 10, at(0, 0));
  for (int k = 1; k <= 12; ++k) {
    EXPECT_NEAR(filter(at(0.1, 0))[0], 0.1 * std::min(k, 10) / 10.0, kRounding);
  }
}

TEST(NominalFilter, LagsARampByItsDelay) {
  for (const auto shape : {FilterShape::mean, FilterShape::triangle}) {
    NominalFilter filter(shape, 30, at(0, 0));
    const double step = 1 * um;
    double y = 0.0;
    for (int k = 0; k <= 100; ++k) y = filter(at(step * k, 0))[0];
    EXPECT_NEAR(y, step * (100 - filter.delay()), kRounding);
  }
}

// (sqrt(2)/8) v T_f for a corner of 90 degrees; samples change it by 1/n^2.
TEST(NominalFilter, CutsACornerByTheClosedForm) {
  const int n = 40;
  const double v = 23.2 * mm;
  NominalFilter filter(FilterShape::mean, n, at(-0.1, 0));
  double least = 1.0;
  for (int k = -400; k <= 400; ++k) {
    const double s = v * kCycle * k;
    const Joints Q = filter(k < 0 ? at(s, 0) : at(0, s));
    if (k > -300) least = std::min(least, Q.norm());
  }
  const double expected = std::sqrt(2.0) / 8.0 * v * n * kCycle;
  EXPECT_NEAR(least, expected, expected * 2.5 / (n * n));
}

// -R (w T_f)^2 / 24, and / 48 for the triangle.
TEST(NominalFilter, ShrinksACircleByTheClosedForm) {
  const int n = 40;
  const double R = 10 * mm, w = 2.32, phase = w * n * kCycle;
  for (const auto& [shape, divisor] :
       {std::pair{FilterShape::mean, 24.0}, std::pair{FilterShape::triangle, 48.0}}) {
    NominalFilter filter(shape, n, at(R, 0));
    double radius = 0.0;
    for (int k = 0; k < 200; ++k) {
      radius = filter(at(R * std::cos(w * kCycle * k), R * std::sin(w * kCycle * k))).norm();
    }
    const double expected = R * phase * phase / divisor;
    // next term of the series and, for samples, 1/n^2 (4/n^2 for the triangle)
    EXPECT_NEAR(R - radius, expected, expected * (phase * phase / 40.0 + 4.5 / (n * n)));
  }
}

}  // namespace
}  // namespace servomill::controllers::nominal_filter_test
