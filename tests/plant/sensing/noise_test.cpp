#include "plant/sensing/noise.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "plant/vocabulary/ticks.h"

namespace servomill::plant::noise_test {
namespace {

using Words = std::array<std::uint32_t, 4>;

constexpr int kCount = 200000;   // ticks
constexpr double kSigmas = 5.0;  // of the estimate: one correct seed in 1.7 million fails
constexpr NoiseKey kKey = {2024, 3};

// First of the two numbers at each of kCount ticks.
std::vector<double> series(const NoiseKey& key, std::uint32_t channel, Tick first = 0) {
  std::vector<double> values;
  for (Tick n = first; n < first + kCount; ++n) values.push_back(white_noise(key, channel, n)[0]);
  return values;
}

double mean_power(const std::vector<double>& values, int power) {
  double sum = 0.0;
  for (const double value : values) sum += std::pow(value, power);
  return sum / kCount;
}

// Correlation of two series of variance 1; its own standard deviation is 1 / sqrt(kCount).
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t n = 0; n < kCount; ++n) sum += a[n] * b[n];
  return sum / kCount;
}

TEST(Philox, GivesTheKnownAnswersOfItsAuthors) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t kOnes = 0xffffffff;
  EXPECT_EQ(philox({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(WhiteNoise, HasTheMomentsOfAStandardNormalNumber) {
  const auto values = series(kKey, 0);
  const double se = kSigmas / std::sqrt(kCount);
  EXPECT_NEAR(mean_power(values, 1), 0.0, se);
  EXPECT_NEAR(mean_power(values, 2), 1.0, se * std::sqrt(2.0));
  EXPECT_NEAR(mean_power(values, 3), 0.0, se * std::sqrt(15.0));
  EXPECT_NEAR(mean_power(values, 4), 3.0, se * std::sqrt(96.0));
}

TEST(WhiteNoise, HasTheTailsOfAStandardNormalNumber) {
  const auto values = series(kKey, 0);
  for (const double bound : {0.5, 1.0, 2.0, 3.0, 4.0}) {
    for (const double side : {-1.0, 1.0}) {
      int beyond = 0;
      for (const double value : values) beyond += side * value > bound;
      const double expected = kCount * 0.5 * std::erfc(bound / std::sqrt(2.0));
      EXPECT_NEAR(beyond, expected, kSigmas * std::sqrt(expected)) << side * bound;
    }
  }
}

TEST(WhiteNoise, IsWhite) {
  const auto now = series(kKey, 0);
  for (const Tick later : {1, 2, 18, 180}) {
    EXPECT_NEAR(correlation(now, series(kKey, 0, later)), 0.0, kSigmas / std::sqrt(kCount));
  }
}

TEST(WhiteNoise, OfDifferentEncodersChannelsAndSeedsIsIndependent) {
  const auto one = series(kKey, 0);
  for (const auto& other : {series({2024, 4}, 0), series({2024, 2}, 0), series({2024, 3}, 1),
                            series({2025, 3}, 0), series({2024 + (1ULL << 32), 3}, 0)}) {
    EXPECT_NEAR(correlation(one, other), 0.0, kSigmas / std::sqrt(kCount));
  }
}

TEST(WhiteNoise, GivesTwoIndependentNumbersAtATime) {
  std::vector<double> first, second;
  for (Tick n = 0; n < kCount; ++n) {
    const auto pair = white_noise(kKey, 0, n);
    first.push_back(pair[0]);
    second.push_back(pair[1]);
  }
  EXPECT_NEAR(correlation(first, second), 0.0, kSigmas / std::sqrt(kCount));
  EXPECT_NEAR(mean_power(second, 2), 1.0, kSigmas * std::sqrt(2.0 / kCount));
}

TEST(WhiteNoise, UsesAllBitsOfTheTick) {
  const double at_zero = white_noise(kKey, 0, 0)[0];
  EXPECT_NE(white_noise(kKey, 0, Tick{1} << 40)[0], at_zero);
  EXPECT_NE(white_noise(kKey, 0, -1)[0], at_zero);
}

// Computed from the definition by tests/plant/sensing/noise_golden.py.
TEST(WhiteNoise, IsTheSameForEver) {
  constexpr double kRoundingTol = 1e-14;  // the mathematics library's last bits
  const auto expect = [&](const std::array<double, 2>& pair, double first, double second) {
    EXPECT_NEAR(pair[0], first, kRoundingTol);
    EXPECT_NEAR(pair[1], second, kRoundingTol);
  };
  expect(white_noise({0, 0}, 0, 0), -0.12151797595308106, -1.3500326598576553);
  expect(white_noise({2024, 3}, 0, 1), 0.0014971685902126408, -0.23365973439638782);
  expect(white_noise({2024, 3}, 1, 1), -1.172357742979792, -1.4524560328808986);
  expect(white_noise({Tick{1} << 40, 9}, 0, (Tick{1} << 33) + 7), -0.42994138599590093,
         -0.85543450246604147);
  expect(white_noise({1, 0}, 0, -1), 0.23164955538113272, -0.62209590619568711);
}

}  // namespace
}  // namespace servomill::plant::noise_test
