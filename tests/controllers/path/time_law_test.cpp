#include "controllers/path/time_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace servomill::controllers::time_law_test {
namespace {

constexpr double kRounding = 1e-8;  // of a limit

struct State {
  double s, v, a, j;
};

State state(const TimeLaw& law, double t) {
  const auto next = std::upper_bound(law.phases.begin(), law.phases.end(), t,
                                     [](double x, const Phase& p) { return x < p.t; });
  const Phase& p = *(next - 1);
  const double x = t - p.t;
  return {p.s + x * (p.v + x * (p.a / 2 + x * p.j / 6)), p.v + x * (p.a + x * p.j / 2),
          p.a + x * p.j, p.j};
}

TEST(TimeLaw, MeetsASlowStretchAtItsLimit) {
  const double j = 100.0;
  const std::vector<SegmentLimits> stretches = {
      {0.1, 0.1, 10.0, j}, {0.2, 0.05, 10.0, j}, {0.3, 0.1, 10.0, j}};
  const TimeLaw law = plan_speed(stretches);
  // a ramp over dv takes 2 sqrt(dv/j) at the mean of its speeds
  const auto ramp = [&](double dv) { return 2.0 * std::sqrt(dv / j); };
  const double fast = 0.1 / 0.1 + ramp(0.1) * 0.5 + ramp(0.05) * (1.0 - 0.75);
  EXPECT_NEAR(law.duration, 2.0 * fast + 0.1 / 0.05, 1e-9);
}

TEST(TimeLaw, StandsAtBothEnds) {
  const TimeLaw law = plan_speed(std::vector<SegmentLimits>{{0.01, 0.1, 2.0, 50.0}});
  const State begin = state(law, 0.0), end = state(law, law.duration);
  EXPECT_EQ(begin.v, 0.0);
  EXPECT_EQ(begin.a, 0.0);
  EXPECT_NEAR(end.s, 0.01, 1e-15);
  EXPECT_NEAR(end.v, 0.0, 1e-12);
  EXPECT_NEAR(end.a, 0.0, 1e-12);
}

// record.max_duration_h allows 24 h. Times are sums of up to 8.6e4 s, rounded to 1.5e-11 s, in
// which a jerk of 1e7 m/s^3 changes the acceleration by 1.5e-4 m/s^2.
TEST(TimeLaw, IsContinuousAfterHoursOfASlowFeed) {
  constexpr double kDay = 86400.0, kSlow = 1e-6;
  for (const double j : {1.0, 1e4, 1e7}) {
    const double length = kSlow * kDay * 0.999;
    const std::vector<SegmentLimits> stretches = {{0.4 * length, kSlow, 10.0, j},
                                                  {0.5 * length, 3.0 * kSlow, 10.0, j},
                                                  {length, kSlow, 10.0, j}};
    const TimeLaw law = plan_speed(stretches);  // asserts that it is
    EXPECT_NEAR(law.duration, kDay * 0.999 * (0.9 + 0.1 / 3.0), 1.0) << j;
    const State end = state(law, law.duration);
    EXPECT_NEAR(end.s, length, 1e-15) << j;
    EXPECT_NEAR(end.v, 0.0, 1e-9) << j;
  }
}

TEST(TimeLaw, KeepsTheLimitsOfRandomStretches) {
  std::mt19937 dice(1);
  const auto log_uniform = [&](double low, double high) {
    return low * std::pow(high / low, static_cast<double>(dice()) / 4294967296.0);
  };
  for (int run = 0; run < 200; ++run) {
    std::vector<SegmentLimits> stretches;
    double end = 0.0;
    for (std::size_t k = 0, n = 1 + dice() % 30; k < n; ++k) {
      end += log_uniform(1e-6, 1e-2);
      stretches.push_back({end, log_uniform(1e-3, 1.0), log_uniform(0.1, 10), log_uniform(1, 500)});
    }
    const TimeLaw law = plan_speed(stretches);
    std::size_t k = 0;
    for (int n = 0; n < 5000; ++n) {
      const State x = state(law, law.duration * n / 5000.0);
      while (k + 1 < stretches.size() && x.s >= stretches[k].end + 1e-12) ++k;
      // within rounding of a border either side may rule
      if (std::abs(x.s - stretches[k].end) < 1e-10) continue;
      ASSERT_LE(x.v, stretches[k].v * (1 + kRounding)) << run;
      ASSERT_GE(x.v, -1e-12) << run;
      ASSERT_LE(std::abs(x.a), stretches[k].a * (1 + kRounding)) << run;
      ASSERT_LE(std::abs(x.j), stretches[k].j * (1 + kRounding)) << run;
    }
  }
}

TEST(TimeLaw, IsFasterOnAShorterSlowStretch) {
  double last = 1e9;
  for (const double slow : {0.05, 0.02, 0.005, 0.0005}) {
    const std::vector<SegmentLimits> stretches = {
        {0.1, 0.1, 5.0, 100.0}, {0.1 + slow, 0.03, 5.0, 100.0}, {0.2, 0.1, 5.0, 100.0}};
    const double duration = plan_speed(stretches).duration;
    EXPECT_LT(duration, last);
    last = duration;
  }
}

TEST(TimeLaw, LeadsFromOneSpeedToAnother) {
  const std::vector<SegmentLimits> even = {{0.1, 0.1, 10.0, 100.0}};
  EXPECT_DOUBLE_EQ(plan_speed(even, {0.1, 0.1})->duration, 1.0);
  const auto law = plan_speed(even, {0.05, 0.1});
  ASSERT_TRUE(law);
  const double ramp = 2.0 * std::sqrt(0.05 / 100.0);  // at the mean of both speeds
  EXPECT_NEAR(law->duration, ramp + (0.1 - 0.075 * ramp) / 0.1, 1e-12);
  EXPECT_EQ(state(*law, 0.0).v, 0.05);
  const State end = state(*law, law->duration);
  EXPECT_NEAR(end.s, 0.1, 1e-15);
  EXPECT_NEAR(end.v, 0.1, 1e-12);
  EXPECT_NEAR(end.a, 0.0, 1e-12);
}

// From v to rest over v sqrt(v/j), both sides of the limit.
TEST(TimeLaw, RefusesWhatCannotBeReached) {
  const double v = 0.1, j = 100.0, way = v * std::sqrt(v / j);
  const auto law = [&](double length) {
    return plan_speed(std::vector<SegmentLimits>{{length, 1.0, 100.0, j}}, {v, 0.0});
  };
  EXPECT_TRUE(law(way * 1.001));
  EXPECT_FALSE(law(way * 0.999));
  const auto back = plan_speed(std::vector<SegmentLimits>{{way * 0.999, 1.0, 100.0, j}}, {0.0, v});
  EXPECT_FALSE(back);
  const std::vector<SegmentLimits> slow = {{1.0, 0.99 * v, 100.0, j}};
  EXPECT_FALSE(plan_speed(slow, {v, 0.0}));
  EXPECT_FALSE(plan_speed_through(slow, v, 0.5));
}

// A place on an even stretch costs nothing.
TEST(TimeLaw, PassesAPlaceAtTheSpeedOfTheStretch) {
  const std::vector<SegmentLimits> even = {{0.1, 0.1, 10.0, 100.0}, {0.3, 0.1, 10.0, 100.0}};
  const auto law = plan_speed_through(even, 0.0, 0.1);
  ASSERT_TRUE(law);
  EXPECT_EQ(law->speed, 0.1);
  EXPECT_NEAR(law->before.duration + law->behind.duration, plan_speed(even).duration, 1e-12);
  EXPECT_EQ(law->behind.phases.front().s, 0.0);
  EXPECT_EQ(law->behind.phases.front().v, 0.1);
}

// A slow stretch d behind the place is met: v is the largest with (v + w)/2 2 sqrt((v - w)/j) <= d.
TEST(TimeLaw, PassesAPlaceNoFasterThanItCanBrake) {
  const double w = 0.01, d = 1e-3, j = 100.0;
  const std::vector<SegmentLimits> stretches = {
      {0.1, 0.5, 100.0, j}, {0.1 + d, 0.5, 100.0, j}, {0.2, w, 100.0, j}};
  const auto law = plan_speed_through(stretches, 0.0, 0.1);
  ASSERT_TRUE(law);
  const double v = law->speed;
  EXPECT_GT(v, w);
  EXPECT_NEAR((v + w) * std::sqrt((v - w) / j), d, 1e-5 * d);
  const State end = state(law->before, law->before.duration);
  EXPECT_NEAR(end.s, 0.1, 1e-15);
  EXPECT_NEAR(end.v, v, 1e-9);
  EXPECT_NEAR(state(law->behind, law->behind.duration).s, 0.1, 1e-15);
}

}  // namespace
}  // namespace servomill::controllers::time_law_test
