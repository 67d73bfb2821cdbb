#include "controllers/servo/current_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace servomill::controllers::current_loop_test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// L di/dt = u - R i with u held: i_(k+1) = a i_k + (1 - a) u / R.
struct Winding {
  double L = 4e-3;   // H
  double R = 0.6;    // ohm
  double Ti = 1e-4;  // s
  double i = 0.0;    // A

  double a() const { return std::exp(-R * Ti / L); }
  double b() const { return (1.0 - a()) / R; }
  void advance(double u) { i = a() * i + b() * u; }
};

// The zero of the PI on the pole of the winding.
CurrentLoopParams cancelling(const Winding& w, double u_max) {
  const double Kp = 14.0;
  return {.Kp = Kp, .Ki = Kp * (1.0 - w.a()) / w.Ti, .u_max = u_max, .Ti = w.Ti};
}

TEST(CurrentLoop, IsProportionalAtOnceAndIntegratesAfterwards) {
  const CurrentLoopParams p{.Kp = 14.0, .Ki = 7000.0, .u_max = 320.0, .Ti = 1e-4};
  CurrentLoopState s;
  current_loop(p, s, 3.0, 1.0);
  EXPECT_DOUBLE_EQ(s.u, 14.0 * 2.0);
  EXPECT_DOUBLE_EQ(s.integral, 7000.0 * 1e-4 * 2.0);
  current_loop(p, s, 3.0, 2.5);
  EXPECT_DOUBLE_EQ(s.u, 14.0 * 0.5 + 1.4);
}

TEST(CurrentLoop, HoldsTheIntegralOnlyWhileTheVoltageIsLimited) {
  const CurrentLoopParams p{.Kp = 10.0, .Ki = 5000.0, .u_max = 320.0, .Ti = 1e-4};
  for (const double sign : {1.0, -1.0}) {
    CurrentLoopState at, beyond;
    current_loop(p, at, sign * 32.0, 0.0);
    EXPECT_EQ(at.u, sign * 320.0);
    EXPECT_FALSE(at.limited());
    EXPECT_NE(at.integral, 0.0);
    current_loop(p, beyond, sign * 32.1, 0.0);
    EXPECT_EQ(beyond.u, sign * 320.0);
    EXPECT_TRUE(beyond.limited());
    EXPECT_EQ(beyond.integral, 0.0);
  }
}

// With the zero on the pole the loop is of first order: i_k = i_cmd (1 - (1 - Kp b)^k).
TEST(CurrentLoop, StepResponseIsGeometricWhenThePoleIsCancelled) {
  constexpr double kRounding = 1e-12;  // A, of 200 steps at 10 A
  Winding w;
  const CurrentLoopParams p = cancelling(w, kInf);
  CurrentLoopState s;
  double rest = 10.0;
  for (int k = 0; k < 200; ++k) {
    ASSERT_NEAR(w.i, 10.0 - rest, kRounding) << "period " << k;
    current_loop(p, s, 10.0, w.i);
    w.advance(s.u);
    rest *= 1.0 - p.Kp * w.b();
  }
}

TEST(CurrentLoop, HoldsItsCurrentAgainstABackVoltage) {
  constexpr double kRounding = 1e-10;  // A, what is left of 10 A after 3000 periods
  const double u_emf = 80.0;           // V
  Winding w;
  CurrentLoopState s;
  for (int k = 0; k < 3000; ++k) {
    current_loop(cancelling(w, 320.0), s, 10.0, w.i);
    w.advance(s.u - u_emf);
  }
  EXPECT_NEAR(w.i, 10.0, kRounding);
  EXPECT_NEAR(s.integral, u_emf + w.R * 10.0, 1e-8);
}

// A step that the voltage cannot follow: with the gate the current arrives as from any smaller
// step, without it the integral has grown meanwhile and carries the current beyond.
TEST(CurrentLoop, ComesOutOfTheLimitWithoutOvershoot) {
  const double u_max = 20.0, i_cmd = 20.0;
  const auto peak = [&](bool gate) {
    Winding w;
    const CurrentLoopParams p = cancelling(w, u_max);
    CurrentLoopState s;
    double highest = 0.0;
    for (int k = 0; k < 2000; ++k) {
      const double before = s.integral, e = i_cmd - w.i;
      current_loop(p, s, i_cmd, w.i);
      if (!gate) s.integral = before + p.Ki * p.Ti * e;
      w.advance(s.u);
      highest = std::max(highest, w.i);
    }
    EXPECT_NEAR(w.i, i_cmd, 1e-6);
    return highest;
  };
  EXPECT_LT(peak(true), 1.01 * i_cmd);
  EXPECT_GT(peak(false), 1.10 * i_cmd);
}

}  // namespace
}  // namespace servomill::controllers::current_loop_test
