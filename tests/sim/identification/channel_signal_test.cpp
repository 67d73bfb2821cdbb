#include "sim/identification/channel_signal.h"

#include <gtest/gtest.h>

#include <limits>

namespace servomill::sim::identification::channel_signal_test {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

TEST(ChannelSignal, IsLinearBetweenTheSamplesThatAreThereAndLate) {
  const recordings::Base base{"time", "s", {0.0, 1.0, 2.0, 4.0}};
  const recordings::Channel channel{"y", "mm", {1.0, kMissing, 5.0, 9.0}, 0};
  ChannelUse use;
  use.factor = 1e-3;
  use.offset = 0.5;
  use.delay = 0.25;
  ChannelSignal signal(channel, base, use, 1.0);
  EXPECT_DOUBLE_EQ(signal.first(), -0.25);
  EXPECT_DOUBLE_EQ(signal.last(), 3.75);
  EXPECT_DOUBLE_EQ(signal(0.75), 0.503);
  EXPECT_DOUBLE_EQ(signal(2.75), 0.507);
  EXPECT_DOUBLE_EQ(signal.gap(0.0), 2.0);
  EXPECT_DOUBLE_EQ(signal(-0.25), 0.501);
}

}  // namespace
}  // namespace servomill::sim::identification::channel_signal_test
