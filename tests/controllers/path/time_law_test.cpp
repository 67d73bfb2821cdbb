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

}  // namespace
}  // namespace servomill::controllers::time_law_test
