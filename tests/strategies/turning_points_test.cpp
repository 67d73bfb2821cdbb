// Turning points of a coordinate along a way.
#include "strategies/turning_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servomill::strategies::turning_points_test {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(TurningPoints, OfASineAreItsCrests) {
  const auto x = [](double t) { return 1e-5 * std::sin(4.0 * kPi * t); };
  const std::vector<double> turns = turning_points(x, 0.0, 1.0, 20);
  ASSERT_EQ(turns.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(turns[i], (1.0 + 2.0 * static_cast<double>(i)) / 8.0, 1e-6);
  }
}

TEST(TurningPoints, LieBetweenTheEnds) {
  const auto x = [](double t) { return (t - 0.3) * (t - 0.3); };
  EXPECT_EQ(turning_points(x, 0.0, 0.29, 4).size(), 0U);
  EXPECT_EQ(turning_points(x, 0.31, 1.0, 4).size(), 0U);
  ASSERT_EQ(turning_points(x, 0.29, 0.31, 4).size(), 1U);
  EXPECT_NEAR(turning_points(x, 0.0, 1.0, 1).at(0), 0.3, 1e-6);
}

TEST(TurningPoints, ARestBetweenTwoDirectionsIsOne) {
  const auto x = [](double t) { return t < 0.4 ? t : std::min(0.4, 1.0 - t); };
  const std::vector<double> turns = turning_points(x, 0.0, 1.0, 50);
  ASSERT_EQ(turns.size(), 1U);
  EXPECT_GE(turns[0], 0.4 - 1e-3);
  EXPECT_LE(turns[0], 0.6 + 1e-3);
}

// Rounding of a correction does not divide a line, a wave of a nanometre does.
TEST(TurningPoints, AreNoneWhereRoundingReverses) {
  const auto wave = [](double amplitude) {
    return [amplitude](double t) { return 1.0 + amplitude * std::sin(20.0 * kPi * t); };
  };
  EXPECT_EQ(turning_points(wave(1e-12), 0.0, 1.0, 100).size(), 0U);
  EXPECT_EQ(turning_points(wave(1e-9), 0.0, 1.0, 100).size(), 20U);
}

}  // namespace
}  // namespace servomill::strategies::turning_points_test
