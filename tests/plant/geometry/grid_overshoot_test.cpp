#include "plant/geometry/grid_overshoot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::plant::grid_overshoot_test {
namespace {

GridFunction line(std::vector<double> at, std::vector<double> error,
                  GridInterpolation interpolation = GridInterpolation::cubic) {
  return GridFunction({{Axis::X}, {std::move(at)}, std::move(error), interpolation});
}

// The cubic through 0, 0, 1, 1 at -1, 0, 1, 2 is 1/2 + 13/12 u - u^3 / 3 with u = q - 1/2: beyond
// 0 and 1 it has its extremes at u = +-sqrt(13/12), 0.2519 outside; at the quarters 0.2500.
TEST(GridOvershoot, OfAStepIsFoundWithItsPlace) {
  const auto found = overshoot_of(line({-1.0, 0.0, 1.0, 2.0}, {0.0, 0.0, 1e-5, 1e-5}));
  ASSERT_TRUE(found);
  const double u = 1.0;  // q = -0.5 or 1.5
  EXPECT_NEAR(found->beyond, (13.0 / 12.0 * u - u * u * u / 3.0 - 0.5) * 1e-5, 1e-15);
  EXPECT_EQ(found->from, -1.0);
  EXPECT_EQ(found->to, 0.0);
  EXPECT_EQ(found->at, std::vector{-0.5});
}

TEST(GridOvershoot, OfALinearGridIsNone) {
  EXPECT_FALSE(
      overshoot_of(line({-1.0, 0.0, 1.0, 2.0}, {0.0, 0.0, 1e-5, 1e-5}, GridInterpolation::linear)));
}

// Half of a sine's range times 1 - cos(pi / n) lies beyond n positions a period.
TEST(GridOvershoot, OfASmoothCurveDoesNotCount) {
  for (const int n : {4, 8}) {
    std::vector<double> at, error;
    for (int i = 0; i <= 4 * n; ++i) {
      at.push_back(0.01 * i);
      error.push_back(1e-5 * std::sin(2.0 * std::numbers::pi * (i + 0.5) / n));
    }
    EXPECT_EQ(overshoot_of(line(at, error)).has_value(), n == 4) << n;
  }
}

TEST(GridOvershoot, IsFoundAlongEveryAxis) {
  GridPoints points{{Axis::Z, Axis::X},
                    {{0.0, 0.1}, {-0.1, 0.0, 0.1, 0.2}},
                    {0, 0, 0, 0, 0, 0, 1e-5, 1e-5},
                    GridInterpolation::cubic};
  const auto found = overshoot_of(GridFunction(points));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->argument, 1U);
  EXPECT_EQ(found->at[0], 0.1);
  EXPECT_NEAR(found->beyond, 2.5e-6, 1e-14);
}

}  // namespace
}  // namespace servomill::plant::grid_overshoot_test
