#include "controllers/path/law_ends.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace servomill::controllers::law_ends_test {
namespace {

constexpr double kSpeed = 0.1, kJerk = 100.0;  // m/s, m/s^3

std::vector<SegmentLimits> even(double length) { return {{length, kSpeed, 10.0, kJerk}}; }

double ramp_time(double dv) { return 2.0 * std::sqrt(dv / kJerk); }

TEST(LawEnds, AtRestTheRampIsGoneThroughMoreSlowly) {
  const TimeLaw law = plan_speed(even(0.1));
  const LawEnds ends(law, {}, {});
  const auto place = ends.begin();
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->t, ramp_time(kSpeed), 1e-12);
  EXPECT_DOUBLE_EQ(place->v, kSpeed);
  const auto slow = ends.before(*place, 0.8 * kSpeed);
  ASSERT_TRUE(slow);
  EXPECT_NEAR(slow->duration, ramp_time(kSpeed) / 0.8, 1e-12);
  EXPECT_NEAR(slow->phases.front().j, kJerk * 0.512, 1e-9);
  EXPECT_FALSE(ends.before(*place, 1.001 * kSpeed));
}

// A new ramp leads from the speed at the begin down to the place; the way to it is as short as a
// ramp to half of the speed.
TEST(LawEnds, ASpeedAtTheEndIsKept) {
  const double length = 0.1;
  const std::vector<SegmentLimits> stretches = even(length);
  const EndSpeeds speeds = {kSpeed, kSpeed};
  const auto law = plan_speed(stretches, speeds);
  ASSERT_TRUE(law);
  const LawEnds ends(*law, stretches, speeds);
  const auto begin = ends.begin(), end = ends.end();
  ASSERT_TRUE(begin && end);
  const double least = 0.75 * kSpeed * ramp_time(0.5 * kSpeed);
  EXPECT_GE(begin->s, least * (1.0 - 1e-9));
  EXPECT_LE(begin->s, least + length / 4000.0);
  EXPECT_NEAR(length - end->s, begin->s, length / 4000.0);
  const double v = 0.7 * kSpeed;
  const auto before = ends.before(*begin, v), behind = ends.behind(*end, v);
  ASSERT_TRUE(before && behind);
  EXPECT_EQ(before->phases.front().v, kSpeed);
  EXPECT_EQ(behind->phases.front().v, v);
  EXPECT_EQ(behind->phases.front().s, end->s);
  const double ramp = ramp_time(0.3 * kSpeed), mean = 0.85 * kSpeed;
  EXPECT_NEAR(before->duration, ramp + (begin->s - mean * ramp) / kSpeed, 1e-12);
  LawEnds::Place near = *begin;
  near.s *= 0.5;
  EXPECT_FALSE(ends.before(near, 0.5 * kSpeed));
}

TEST(LawEnds, FindsNoPlaceWhereThereIsNoRoom) {
  const std::vector<SegmentLimits> stretches = even(1e-3);
  const EndSpeeds speeds = {kSpeed, kSpeed};
  const auto law = plan_speed(stretches, speeds);
  ASSERT_TRUE(law);
  EXPECT_FALSE(LawEnds(*law, stretches, speeds).begin());
}

}  // namespace
}  // namespace servomill::controllers::law_ends_test
