#include "controllers/servo/backlash_compensation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "controllers/servo/cascade.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::backlash_compensation_test {
namespace {

constexpr double kTp = 0.2e-3;  // s

BacklashCompensationParams heidenhain() {
  return {.width = 0.03 * mm, .time = 15 * ms, .hysteresis = 20 * nm, .Tp = kTp};
}

TEST(BacklashCompensation, GivesTheSpeedOfTheHandbookForItsTime) {
  const BacklashCompensationParams p = heidenhain();
  BacklashCompensationState s = standing_at(p, 0.0);
  backlash_compensation(p, s, 1.0 * mm);
  int periods = 0;
  for (int k = 0; k < 200; ++k) {
    const BacklashRamp ramp = backlash_compensation(p, s, 0.9 * mm);
    if (ramp.rate == 0.0) continue;
    ++periods;
    EXPECT_NEAR(ramp.rate, -120.0 * mm_per_min, 1e-12);  // m/s, rounding of offsets
  }
  EXPECT_EQ(periods, 75);  // of 0.2 ms: 15 ms
  EXPECT_EQ(s.offset, -p.width);
}

TEST(BacklashCompensation, CrossesTheGapExactlyInWholePeriods) {
  BacklashCompensationParams p = heidenhain();
  for (const double time : {0.0, 0.05 * ms, 0.31 * ms, 7 * ms, 15.09 * ms}) {
    p.time = time;
    BacklashCompensationState s = standing_at(p, 0.0);
    double way = 0.0;
    for (int k = 0; k < 200; ++k) way += kTp * backlash_compensation(p, s, -1.0 * mm).rate;
    EXPECT_NEAR(way, -p.width, 1e-18);  // m, rounding
    for (int k = 0; k < 200; ++k) way += kTp * backlash_compensation(p, s, 0.0).rate;
    EXPECT_NEAR(way, 0.0, 1e-18);
    EXPECT_EQ(s.offset, 0.0);
  }
}

TEST(BacklashCompensation, TurnsRoundWhenTheMotionDoes) {
  const BacklashCompensationParams p = heidenhain();
  BacklashCompensationState s = standing_at(p, 0.0);
  for (int k = 0; k < 30; ++k) backlash_compensation(p, s, -1.0 * mm);
  EXPECT_NEAR(s.offset, -p.width * 30 / 75, 1e-18);
  for (int k = 0; k < 29; ++k) EXPECT_GT(backlash_compensation(p, s, 0.0).rate, 0.0);
  EXPECT_LT(s.offset, 0.0);
  backlash_compensation(p, s, 0.0);
  EXPECT_EQ(s.offset, 0.0);
  EXPECT_EQ(backlash_compensation(p, s, 0.0).rate, 0.0);
}

TEST(BacklashCompensation, IgnoresNoiseWithinTheHysteresis) {
  const BacklashCompensationParams p = heidenhain();
  std::mt19937 dice(8);
  BacklashCompensationState s = standing_at(p, 0.1);
  for (int k = 0; k < 10000; ++k) {
    const double q = 0.1 + 9.9 * nm * (static_cast<double>(dice()) / 2147483648.0 - 1.0);
    ASSERT_EQ(backlash_compensation(p, s, q).rate, 0.0);
  }
}

TEST(BacklashCompensation, ReversesBeyondTheHysteresisOnly) {
  const BacklashCompensationParams p = heidenhain();
  for (const double back : {19.9 * nm, 20.1 * nm}) {
    BacklashCompensationState s = standing_at(p, 0.0);
    backlash_compensation(p, s, 1.0 * um);
    EXPECT_EQ(backlash_compensation(p, s, 1.0 * um - back).rate<0.0, back> p.hysteresis);
  }
}

TEST(BacklashCompensation, FindsASlowReversalToo) {
  const BacklashCompensationParams p = heidenhain();
  BacklashCompensationState s = standing_at(p, 0.0);
  int direction = 1;
  for (int k = 0; k < 100; ++k) {  // 1 nm per period
    backlash_compensation(p, s, -1.0 * nm * k);
    if (s.direction != direction) {
      EXPECT_EQ(k, 21);
      direction = s.direction;
    }
  }
  EXPECT_EQ(direction, -1);
}

TEST(BacklashCompensation, OfNoWidthDoesNothing) {
  const BacklashCompensationParams p;
  BacklashCompensationState s = standing_at(p, 0.0);
  for (int k = 0; k < 100; ++k) {
    const BacklashRamp ramp = backlash_compensation(p, s, std::sin(0.1 * k));
    EXPECT_EQ(ramp.rate, 0.0);
    EXPECT_EQ(ramp.offset, 0.0);
  }
}

// An ideal motor with a slide behind a gap of 30 um, to and fro over 10 mm with `v` (m/s) at the
// turn. Greatest error of the slide (m) after the first reversal, without that of its first second.
enum class Loop { scale, motor };
struct SlideError {
  double greatest, mean;
};
SlideError to_and_fro(Loop loop, BacklashCompensationParams p) {
  const double gap = 0.03 * mm, A = 5 * mm, w = 2.0 * std::numbers::pi * 0.5;
  CascadeParams c;
  c.Kv = 250.0 / 3.0;
  c.kvf = 1.0;
  CascadeState s;
  double motor = -A, slide = -A;  // the positive flank carries
  BacklashCompensationState state = standing_at(p, -A);
  SlideError e{0.0, 0.0};
  int count = 0;
  for (int k = 0; k * kTp < 5.0; ++k) {
    const double a = w * k * kTp, q = -A * std::cos(a), dq = A * w * std::sin(a);
    if (k * kTp > 1.0) {
      e.greatest = std::max(e.greatest, std::abs(q - slide));
      e.mean += std::abs(q - slide);
      ++count;
    }
    const BacklashRamp ramp = backlash_compensation(p, state, q);
    if (loop == Loop::scale) {
      position_loop(c, s, q, slide, dq, 0.0, ramp.rate);
    } else {
      position_loop(c, s, q + ramp.offset, motor, dq, 0.0);
    }
    motor += kTp * s.v_cmd;
    slide = std::clamp(slide, motor, motor + gap);
  }
  e.mean /= count;
  return e;
}

TEST(BacklashCompensation, WithTheScaleGetsAcrossBeforeTheLoopWould) {
  BacklashCompensationParams p = heidenhain(), none = heidenhain();
  none.width = 0.0;
  EXPECT_LT(to_and_fro(Loop::scale, p).greatest, 0.4 * to_and_fro(Loop::scale, none).greatest);
}

TEST(BacklashCompensation, WithTheMotorEncoderRemovesTheGapFromThePosition) {
  BacklashCompensationParams p = heidenhain(), none = heidenhain();
  none.width = 0.0;
  EXPECT_NEAR(to_and_fro(Loop::motor, none).greatest, 30 * um, 1 * um);
  EXPECT_LT(to_and_fro(Loop::motor, p).mean, 0.1 * to_and_fro(Loop::motor, none).mean);
}

}  // namespace
}  // namespace servomill::controllers::backlash_compensation_test
