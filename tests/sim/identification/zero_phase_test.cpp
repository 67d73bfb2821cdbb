#include "sim/identification/zero_phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace servomill::sim::identification::zero_phase_test {
namespace {

std::vector<double> sine(double frequency, std::size_t count) {
  std::vector<double> out;
  for (std::size_t k = 0; k < count; ++k) {
    out.push_back(std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(k)));
  }
  return out;
}

TEST(ZeroPhase, AButterworthFilterHasItsAmplitudeSquaredAndNoPhase) {
  constexpr double kCorner = 0.05;
  for (const int order : {2, 4, 6}) {
    for (const double f : {0.01, 0.05, 0.08}) {
      const auto x = sine(f, 2000), y = zero_phase(x, kCorner, order);
      // of the prewarped prototype
      const double ratio = std::tan(std::numbers::pi * f) / std::tan(std::numbers::pi * kCorner);
      const double gain = 1.0 / (1.0 + std::pow(ratio, 2 * order));
      for (std::size_t k = 900; k < 1100; ++k) EXPECT_NEAR(y[k], gain * x[k], 1e-6) << order << f;
    }
  }
}

TEST(ZeroPhase, ConstantsAndLinesPassToTheirEnds) {
  std::vector<double> line;
  for (int k = 0; k < 500; ++k) line.push_back(3.0 + 0.25 * k);
  const auto y = zero_phase(line, 0.05);
  for (std::size_t k = 0; k < line.size(); ++k) EXPECT_NEAR(y[k], line[k], 1e-6);
}

TEST(ZeroPhase, DerivativesOfAParabolaAreExactInside) {
  std::vector<double> x;
  for (int k = 0; k < 20; ++k) x.push_back(0.5 * k * k);
  const auto v = derivative(x, 0.1);
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    EXPECT_DOUBLE_EQ(v[k], static_cast<double>(k) / 0.1);
  }
}

}  // namespace
}  // namespace servomill::sim::identification::zero_phase_test
