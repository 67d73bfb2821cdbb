/// Speeds at which a drive with friction is linear.
#include "plant/drives/gliding.h"

#include <gtest/gtest.h>

#include "tests/plant/drives/drives.h"

namespace servomill::plant::gliding_test {
namespace {

TEST(Gliding, begins_where_friction_no_longer_changes) {
  FeedDriveParams p = x_axis_with(FrictionKind::set_valued);
  EXPECT_EQ(gliding_of(p).speed, kStribeckEnd * p.friction.vs);
  p.friction.Fs_positive = p.friction.Fs_negative = 450;  // as Fc
  EXPECT_EQ(gliding_of(p).speed, 0.0);
  p.friction.kind = FrictionKind::regularised;
  EXPECT_EQ(gliding_of(p).speed, kTanhEnd * p.friction.v0);
  EXPECT_EQ(gliding_of(p).force(1.0), 450.0);
  EXPECT_EQ(gliding_of(p).force(-1.0), -450.0);
}

TEST(Gliding, of_bristles_waits_until_they_have_settled) {
  const Gliding g = gliding_of(x_axis_with(FrictionKind::lugre));
  EXPECT_TRUE(g.holds(1.0, 450.0 / 5e7));
  EXPECT_FALSE(g.holds(1.0, 449.0 / 5e7));
}

TEST(Gliding, is_nowhere_for_forces_that_change_and_beds_that_move) {
  FeedDriveParams p = x_axis_with(FrictionKind::set_valued);
  p.friction.b_positive = 100.0;
  EXPECT_FALSE(gliding_of(p).holds(100.0));
  p = x_axis_with(FrictionKind::set_valued);
  p.gap = 1e-6;
  EXPECT_FALSE(gliding_of(p).holds(100.0));
  p = x_axis_with(FrictionKind::set_valued);
  p.bed.M = 5000.0;
  EXPECT_FALSE(gliding_of(p).holds(100.0));
}

}  // namespace
}  // namespace servomill::plant::gliding_test
