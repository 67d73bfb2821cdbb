#include "sim/recordings/fourier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace servomill::sim::recordings::fourier_test {
namespace {

constexpr double kRounding = 1e-12;  // of sums of 45 numbers of the order of one

TEST(Fourier, LinesOfASineAndAConstant) {
  constexpr std::size_t kCount = 45;
  std::vector<double> samples;
  for (std::size_t n = 0; n < kCount; ++n) {
    samples.push_back(2.0 +
                      std::sin(2.0 * std::numbers::pi * 7.0 * static_cast<double>(n) / kCount));
  }
  const auto lines = fourier_lines(samples, 20);
  ASSERT_EQ(lines.size(), 20u);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    std::complex<double> expected = 0.0;
    if (k == 0) expected = 2.0 * kCount;
    if (k == 7) expected = {0.0, -0.5 * kCount};
    EXPECT_NEAR(std::abs(lines[k] - expected), 0.0, kRounding) << k;
  }
}

TEST(Fourier, EnergyOfTheSamplesIsThatOfTheLines) {
  const std::vector<double> samples = {1.0, -2.0, 0.5, 3.0, 7.0, -1.25, 0.1};
  double energy = 0.0, of_lines = 0.0;
  for (const double sample : samples) energy += sample * sample;
  for (const auto& line : fourier_lines(samples, samples.size())) of_lines += std::norm(line);
  EXPECT_NEAR(of_lines / static_cast<double>(samples.size()), energy, kRounding);
}

}  // namespace
}  // namespace servomill::sim::recordings::fourier_test
