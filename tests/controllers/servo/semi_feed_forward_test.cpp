// Lag, semi and full velocity feed-forward: what is left of v / Kv. The velocity loop is ideal.
#include <gtest/gtest.h>

#include "controllers/servo/cascade.h"

namespace servomill::controllers::semi_feed_forward_test {
namespace {

constexpr double kTp = 0.2e-3;       // s
constexpr double kRounding = 1e-13;  // m, one bit of 0.5 m over Kv Tp

double steady_lag(double Kv, double kvf, double v) {
  CascadeParams p;
  p.Kv = Kv;
  p.kvf = kvf;
  CascadeState s;
  double y = 0.0, lag = 0.0;
  for (int k = 0; k < 25000; ++k) {
    const double q_cmd = v * k * kTp;
    lag = q_cmd - y;
    position_loop(p, s, q_cmd, y, v, 0.0);
    y += kTp * s.v_cmd;
  }
  return lag;
}

TEST(SemiFeedForward, LeavesItsShareOfTheLag) {
  const double v = 0.1;  // m/s
  for (const double Kv : {50.0, 250.0 / 3.0}) {
    for (const double kvf : {0.0, 0.001, 0.5, 0.9, 0.999, 1.0}) {
      EXPECT_NEAR(steady_lag(Kv, kvf, v), (1.0 - kvf) * v / Kv, kRounding) << Kv << ", " << kvf;
    }
  }
}

// With a gain of its own (Heidenhain MP1396 and MP1516) semi feed-forward can have the lag of full
// lag mode at a fraction of its gain.
TEST(SemiFeedForward, TradesGainForFeedForward) {
  EXPECT_NEAR(steady_lag(20.0, 0.75, 0.1), steady_lag(80.0, 0.0, 0.1), kRounding);
}

}  // namespace
}  // namespace servomill::controllers::semi_feed_forward_test
