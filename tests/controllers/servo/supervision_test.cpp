#include "controllers/servo/supervision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::supervision_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Motor and scale agree with `y`.
AxisReading reading(double q_cmd, double dq_cmd, double y) { return {q_cmd, dq_cmd, y, y, y}; }

SupervisionParams following(double limit) {
  SupervisionParams p;
  p.following_error = limit;
  p.Tp = 0.2 * ms;
  return p;
}

TEST(Supervision, WithoutLimitsFindsNothing) {
  SupervisionState s;
  EXPECT_EQ(supervise({}, s, {1e9, 0.0, -1e9, 1e6, -1e6}), std::nullopt);
}

TEST(Supervision, KeepsAFollowingErrorThatIsJustReached) {
  SupervisionState s;
  const SupervisionParams p = following(0.5);
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(supervise(p, s, reading(sign * 0.5, 1.0, 0.0)), std::nullopt);
    const double beyond = sign * std::nextafter(0.5, 1.0);
    EXPECT_EQ(supervise(p, s, reading(beyond, 1.0, 0.0)),
              (AxisFault{AxisFaultKind::following_error, beyond, 0.5}));
  }
}

TEST(Supervision, StopsOnAReadingThatIsNoNumber) {
  SupervisionState s;
  const auto fault = supervise(following(1.0), s, reading(0.0, 1.0, kNaN));
  ASSERT_TRUE(fault.has_value());
  EXPECT_EQ(fault->fault, AxisFaultKind::following_error);
  EXPECT_TRUE(std::isnan(fault->value));
}

TEST(Supervision, WatchesStandstillAfterItsDelayOnly) {
  SupervisionParams p = following(1.0 * mm);
  p.standstill = 5 * um;
  p.standstill_delay = 0.9 * ms;  // 4.5 periods after the one that stops
  SupervisionState s;
  const double y = -6 * um;
  for (int k = 0; k < 3; ++k) EXPECT_EQ(supervise(p, s, reading(0.0, 0.1, y)), std::nullopt);
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(supervise(p, s, reading(0.0, 0.0, y)), std::nullopt) << "period " << k;
  }
  EXPECT_EQ(supervise(p, s, reading(0.0, 0.0, y)),
            (AxisFault{AxisFaultKind::standstill, 6 * um, 5 * um}));
  EXPECT_EQ(supervise(p, s, reading(0.0, 0.0, -4 * um)), std::nullopt);
}

TEST(Supervision, GrantsTheDelayAnewAfterEachMotion) {
  SupervisionParams p = following(1.0 * mm);
  p.standstill = 5 * um;
  p.standstill_delay = 0.9 * ms;
  SupervisionState s;
  for (int k = 0; k < 100; ++k) {  // moves for a moment every fifth period
    EXPECT_EQ(supervise(p, s, reading(0.0, k % 5 == 0 ? 0.1 : 0.0, 6 * um)), std::nullopt);
  }
}

TEST(Supervision, CountsTheEncoderDifferenceFromTheStart) {
  SupervisionParams p;
  p.encoder_difference = 100 * um;
  SupervisionState s = standing_at(p, {0.3, 0.0, 0.3, 0.1, 0.3});
  AxisReading now{0.3, 0.1, 0.3, 0.1, 0.3 + 99 * um};
  EXPECT_EQ(supervise(p, s, now), std::nullopt);
  now.y_scale = 0.3 + 101 * um;
  const auto fault = supervise(p, s, now);
  ASSERT_TRUE(fault.has_value());
  EXPECT_EQ(fault->fault, AxisFaultKind::encoder_difference);
  EXPECT_NEAR(fault->value, 101 * um, 1e-16);  // m, rounding at 0.3 m
  EXPECT_EQ(fault->limit, 100 * um);
}

TEST(Supervision, NamesTheFollowingErrorFirst) {
  SupervisionParams p = following(1 * um);
  p.standstill = 1 * um;
  p.encoder_difference = 1 * um;
  SupervisionState s;
  EXPECT_EQ(supervise(p, s, {0.0, 0.0, 1.0, 1.0, 2.0})->fault, AxisFaultKind::following_error);
  p.following_error = kNoLimit;
  EXPECT_EQ(supervise(p, s, {0.0, 0.0, 1.0, 1.0, 2.0})->fault, AxisFaultKind::standstill);
  p.standstill = kNoLimit;
  EXPECT_EQ(supervise(p, s, {0.0, 0.0, 1.0, 1.0, 2.0})->fault, AxisFaultKind::encoder_difference);
}

}  // namespace
}  // namespace servomill::controllers::supervision_test
