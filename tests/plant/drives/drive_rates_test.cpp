#include "plant/drives/drive_rates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/plant/drives/drives.h"

namespace servomill::plant::drive_rates_test {
namespace {

TEST(DriveRates, WhatCannotBeRepresentedIsRefusedWithTheRate) {
  FeedDriveParams p = x_axis_with(FrictionKind::regularised);
  EXPECT_TRUE(unrepresentable(p, kTick).empty());
  p.friction.v0 = 1e-9;
  EXPECT_EQ(
      unrepresentable(p, kTick),
      std::vector<std::string>{
          "the slope of the regularised friction, breakaway / (regularisation_velocity mass), "
          "gives a rate of 7.47e+08 1/s; the exact integrator resolves up to 1e+08 1/s"});
  p = x_axis_with(FrictionKind::set_valued);
  p.k = 1e20;
  EXPECT_EQ(unrepresentable(p, kTick).size(), 1U);
}

// The undamped modes of a rigid mass are none: its sub-steps are as long as events allow.
TEST(DriveRates, HalvingsGoDownToTheLengthOfAnEvent) {
  constexpr double kEvent = 10e-9;  // s
  FeedDriveParams p = x_axis_with(FrictionKind::none);
  p.kind = DriveKind::rigid;
  for (const double base : {1e-6, 10e-6, 50e-6}) {
    const int halvings = halvings_of(p, base);
    EXPECT_LE(std::ldexp(base, -halvings), kEvent);
    EXPECT_GT(std::ldexp(base, 1 - halvings), kEvent);
  }
}

TEST(DriveRates, SharpFrictionMakesSubStepsShorter) {
  FeedDriveParams p = x_axis_with(FrictionKind::regularised);
  p.friction.v0 = 1e-5;
  const int before = halvings_of(p, kTick);
  p.friction.v0 *= 0.25;
  EXPECT_EQ(halvings_of(p, kTick), before + 2);
}

}  // namespace
}  // namespace servomill::plant::drive_rates_test
