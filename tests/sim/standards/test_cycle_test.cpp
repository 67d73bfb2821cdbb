#include "sim/standards/test_cycle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace servomill::sim::standards::test_cycle_test {
namespace {

TEST(TestCycle, ApproachesAllTargetsUpwardsThenDownwardsAndReversesBeyondThem) {
  const std::vector<CycleStop> all = stops({.targets = {0.1, 0.2}, .runs = 2, .overrun = 0.01});
  const std::vector<double> positions = {0.09, 0.1, 0.2,  0.21, 0.2, 0.1, 0.09,
                                         0.1,  0.2, 0.21, 0.2,  0.1, 0.09};
  const std::vector<int> directions = {0, 1, 1, 0, -1, -1, 0, 1, 1, 0, -1, -1, 0};
  ASSERT_EQ(all.size(), positions.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_DOUBLE_EQ(all[k].position, positions[k]) << k;
    EXPECT_EQ(all[k].direction, directions[k]) << k;
    if (directions[k] != 0) {
      EXPECT_EQ(all[k].run, k < 6 ? 0 : 1) << k;
      EXPECT_EQ(all[k].target, positions[k] == 0.1 ? 0U : 1U) << k;
    }
  }
}

TEST(SpacedTargets, HoldTheirEndsAndDisplaceTheOthersByLessThanTheSpread) {
  const std::vector<double> even = spaced_targets(-0.1, 0.3, 5, 0.0, 1);
  const std::vector<double> spread = spaced_targets(-0.1, 0.3, 5, 0.02, 1);
  ASSERT_EQ(even.size(), 5U);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(even[static_cast<std::size_t>(i)], -0.1 + 0.1 * i, 1e-15);
  EXPECT_EQ(spread.front(), even.front());
  EXPECT_EQ(spread.back(), even.back());
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_NE(spread[i], even[i]);
    EXPECT_LT(std::abs(spread[i] - even[i]), 0.02);
  }
  EXPECT_EQ(spread, spaced_targets(-0.1, 0.3, 5, 0.02, 1));
  EXPECT_NE(spread, spaced_targets(-0.1, 0.3, 5, 0.02, 2));
}

TEST(UsualTargetCount, IsFiveAMetreAndFiveAtLeast) {
  EXPECT_EQ(usual_target_count(0.3), 5);
  EXPECT_EQ(usual_target_count(1.0), 5);
  EXPECT_EQ(usual_target_count(1.5), 8);
}

}  // namespace
}  // namespace servomill::sim::standards::test_cycle_test
