#include "controllers/servo/cascade.h"
#include "sim/frequency/axis_signals.h"

#include <gtest/gtest.h>

namespace servomill::controllers::cascade_test {
namespace {

CascadeParams unit_axis() {
  CascadeParams p;
  p.Kv = 60.0;
  p.kvf = 1.0;
  p.kaf = 1.0;
  p.Kp = 3.0;
  p.Ki = 150.0;
  p.r = 0.002;
  p.Kt = 1.5;
  p.J = 0.02;
  p.i_max = 50.0;
  p.Tv = 0.2e-3;
  return p;
}

TEST(PositionLoop, CommandsKvTimesTheErrorPlusFeedForward) {
  CascadeState s;
  position_loop(unit_axis(), s, 0.010, 0.009, 0.5, 2.0);
  EXPECT_DOUBLE_EQ(s.v_cmd, 60.0 * (0.010 - 0.009) + 0.5);
  EXPECT_DOUBLE_EQ(s.i_ff, 0.02 * 2.0 / (0.002 * 1.5));
}

TEST(PositionLoop, IgnoresTheFeedForwardInLagMode) {
  CascadeParams p = unit_axis();
  p.kvf = p.kaf = 0.0;
  CascadeState s;
  position_loop(p, s, 1.0, 0.5, 123.0, 456.0);
  EXPECT_EQ(s.v_cmd, 30.0);
  EXPECT_EQ(s.i_ff, 0.0);
}

TEST(VelocityLoop, IsProportionalAtFirstAndIntegratesAfterwards) {
  const CascadeParams p = unit_axis();
  CascadeState s;
  s.v_cmd = 0.002;  // 1 rad/s
  velocity_loop(p, s, 0.0);
  EXPECT_DOUBLE_EQ(s.i_next, 3.0 / 1.5);
  velocity_loop(p, s, 0.0);
  EXPECT_DOUBLE_EQ(s.i_next, (3.0 + 150.0 * 0.2e-3) / 1.5);
}

TEST(VelocityLoop, MeasuresSpeedOverOnePeriod) {
  CascadeParams p = unit_axis();
  p.Ki = 0.0;
  CascadeState s;
  velocity_loop(p, s, 0.4e-3);  // 2 rad/s
  EXPECT_DOUBLE_EQ(s.i_next, -3.0 * 2.0 / 1.5);
}

TEST(VelocityLoop, HoldsTheIntegralOnlyWhileTheCurrentIsLimited) {
  const CascadeParams p = unit_axis();
  CascadeState inside;
  inside.v_cmd = 24.9 * p.r;  // 49.8 A
  velocity_loop(p, inside, 0.0);
  EXPECT_LT(inside.i_next, p.i_max);
  EXPECT_GT(inside.integral, 0.0);
  CascadeState outside;
  outside.v_cmd = 25.1 * p.r;  // 50.2 A
  velocity_loop(p, outside, 0.0);
  EXPECT_EQ(outside.i_next, p.i_max);
  EXPECT_EQ(outside.integral, 0.0);
}

TEST(CurrentCommand, ActsOnePeriodAfterTheVelocityLoop) {
  const CascadeParams p = unit_axis();
  CascadeState s;
  s.v_cmd = 0.002;
  latch_current_command(s);
  velocity_loop(p, s, 0.0);
  EXPECT_EQ(s.i_cmd, 0.0);
  latch_current_command(s);
  EXPECT_DOUBLE_EQ(s.i_cmd, 2.0);
}

}  // namespace
}  // namespace servomill::controllers::cascade_test
