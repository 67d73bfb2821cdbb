/// The observer against closed forms: what it follows, what it lags, what noise it passes.
#include "strategies/motion_observer.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace servomill::strategies::motion_observer_test {
namespace {

constexpr double kT = 60e-6;                          // s
constexpr double kW = 2.0 * std::numbers::pi * 50.0;  // rad/s

Joints along(double x) { return Joints(x, -2.0 * x, 0.0, 0.1 * x, 1.0); }

TEST(ObservedMotion, FollowsAConstantAccelerationWithoutLag) {
  const ObserverGains gains = observer_gains(kW, kT);
  ObservedMotion motion;
  motion.settle(along(0.0));
  const double a = 6.0, v = -0.3;  // m/s^2, m/s
  double t = 0.0;
  for (int n = 0; n < 5000; ++n) {
    t += kT;
    motion.advance(gains, along(v * t + 0.5 * a * t * t));
  }
  constexpr double kDecayed = 1e-10;  // m, m/s; of 0.3 s and 94 time constants, and rounding
  EXPECT_NEAR(motion.position[0], v * t + 0.5 * a * t * t, kDecayed);
  EXPECT_NEAR(motion.velocity[0], v + a * t, kDecayed);
  EXPECT_NEAR(motion.velocity[1], -2.0 * (v + a * t), kDecayed);
  EXPECT_NEAR(motion.acceleration[3], 0.1 * a, 1e-6);
  const double ahead = t + 9e-3;
  EXPECT_NEAR(motion.ahead(9e-3)[0], v * ahead + 0.5 * a * ahead * ahead, kDecayed);
}

TEST(ObservedMotion, LagsAJerkByThreeTimesItOverTheSquareOfItsBandwidth) {
  const ObserverGains gains = observer_gains(kW, kT);
  ObservedMotion motion;
  motion.settle(Joints::Zero());
  const double jerk = 100.0;  // m/s^3
  double t = 0.0;
  for (int n = 0; n < 5000; ++n) {
    t += kT;
    motion.advance(gains, Joints::Constant(jerk * t * t * t / 6.0));
  }
  const double lag = 0.5 * jerk * t * t - motion.velocity[0];
  EXPECT_NEAR(lag, 3.0 * jerk / (kW * kW), 0.01 * lag);  // 1 %: sampled
}

TEST(ObservedMotion, HasTheResponseOfItsRecursion) {
  const ObserverGains gains = observer_gains(kW, kT);
  for (const double f : {1.0, 30.0, 400.0}) {
    const double w = 2.0 * std::numbers::pi * f;
    ObservedMotion motion;
    const auto [p, v, a] = observer_response(gains, w);
    std::complex<double> turn;
    for (int n = 0; n < 20000; ++n) {
      turn = std::polar(1.0, w * kT * n);
      motion.advance(gains, Joints::Constant(turn.imag()));
    }
    constexpr double kRounding = 1e-8;
    EXPECT_NEAR(motion.position[0], (p * turn).imag(), kRounding);
    EXPECT_NEAR(motion.velocity[0], (v * turn).imag(), kRounding * w);
    EXPECT_NEAR(motion.acceleration[0], (a * turn).imag(), kRounding * w * w);
  }
  // slow motions: position, derivative, second derivative
  const double slow = 2.0 * std::numbers::pi * 0.5;
  const auto [p, v, a] = observer_response(gains, slow);
  EXPECT_NEAR(std::abs(p - 1.0), 0.0, 1e-6);
  EXPECT_NEAR(std::abs(v - std::complex<double>(0.0, slow)), 0.0, 1e-3 * slow);
  EXPECT_NEAR(std::abs(a + slow * slow), 0.0, 0.05 * slow * slow);
}

// The velocity of a window of 3 ms has the noise sigma sqrt(2) / 3 ms; the observer's, with half of
// its lag, is several times less.
TEST(ObservedMotion, PassesLessNoiseThanADifferenceOverAWindow) {
  const ObserverGains gains = observer_gains(kW, kT);
  std::mt19937_64 generator(5);
  std::normal_distribution<double> noise(0.0, 1.0);
  ObservedMotion motion;
  double sum = 0.0;
  constexpr int kSettled = 2000, kCount = 200'000;
  for (int n = 0; n < kSettled + kCount; ++n) {
    motion.advance(gains, Joints::Constant(noise(generator)));
    if (n >= kSettled) sum += motion.velocity[0] * motion.velocity[0];
  }
  EXPECT_LT(std::sqrt(sum / kCount), 0.4 * std::sqrt(2.0) / 3e-3);
}

}  // namespace
}  // namespace servomill::strategies::motion_observer_test
