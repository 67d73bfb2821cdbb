// The instant of a planned program at which a run of it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "planned_motion.h"

namespace servomill::strategies::path_place_test {
namespace {

using namespace planned_motion;

TEST(PathPlace, OfTheSamePlanIsItsTime) {
  const PathTimes plan = times_of(TwoMoves(kFeed, 0.05));
  PathPlace place(plan);
  for (std::size_t n = 0; n < plan.s.size(); ++n) {
    const auto whole = static_cast<double>(n);
    EXPECT_NEAR(place.advance(whole * kH, plan.s[n]), whole, kRoundingOfT);
  }
}

TEST(PathPlace, WhereSStandsIsAtAnyFractionOfAnInstant) {
  const PathTimes plan = times_of(TwoMoves(kFeed, 0.05));
  const double arrival = std::ceil(SCurve(kL, kFeed).duration() / kH);
  PathPlace place(plan);
  place.advance((arrival - 1.0) * kH, plan.s[static_cast<std::size_t>(arrival) - 1]);
  place.advance(arrival * kH, kL);
  for (const double t : {0.25, 0.3, 7.7, 100.5, 200.0}) {
    EXPECT_NEAR(place.advance((arrival + t) * kH, kL), arrival + t, kRoundingOfT);
  }
}

// The cubic between two instants misses an arc of constant jerk by what central differences miss of
// its slopes, jerk h^3 / 6, and at a change of jerk by as much again.
constexpr double kMissed = kJerk * kH * kH * kH / 3.0;  // m
constexpr double kMissedAtFeed = 1e-3;                  // instants; of some um that each is long

// Runs the motion at another feed, between the instants of the plan as well, and compares places.
void expect_same_places(const SCurve& plan, const SCurve& run) {
  const PathTimes times = times_of(plan);
  PathPlace place(times);
  double furthest = 0.0, least = 1e9;
  for (double t = 0.0; t <= run.duration(); t += kH) {
    const double s = run.at(t), n = place.advance(t, s);
    EXPECT_NEAR(plan.at(n * kH), s, kMissed) << t;
    const double per_instant = plan.at((n + 1.0) * kH) - plan.at(n * kH);
    if (per_instant < 5.0 * um) continue;
    double low = 0.0, high = plan.duration();
    for (int k = 0; k < 60; ++k) {
      const double mid = 0.5 * (low + high);
      (plan.at(mid) < s ? low : high) = mid;
    }
    EXPECT_NEAR(n, high / kH, kMissedAtFeed) << t;
    furthest = std::max(furthest, n);
    least = std::min(least, n);
  }
  EXPECT_LT(least, 0.2 * plan.duration() / kH);
  EXPECT_GT(furthest, 0.8 * plan.duration() / kH);
}

TEST(PathPlace, AtAnotherFeedIsWhereThePlanIsAtTheSamePlace) {
  for (const double times : {0.5, 0.77, 2.0}) {
    expect_same_places(SCurve(kL, kFeed), SCurve(kL, times * kFeed));
  }
}

TEST(PathPlace, IsAsExactWithAnotherJerkLimitedRamp) {
  expect_same_places(SCurve(kL, kFeed, 1.0), SCurve(kL, kFeed, 0.4));
}

// With its own dwell the run is in that of the plan from its beginning on, and goes on with it.
TEST(PathPlace, OfADwellCountsFromItsBeginning) {
  constexpr double kPlanned = 0.1;  // s
  const TwoMoves plan(kFeed, kPlanned);
  const PathTimes times = times_of(plan);
  const double arrival = std::ceil(plan.move.duration() / kH);
  const double departure = std::floor(plan.departure() / kH);
  constexpr double kApproach = 2.0;  // instants within a picometre of the stop, which count as it
  for (const double seconds : {0.04, kPlanned, 0.25}) {
    const TwoMoves run(0.5 * kFeed, seconds);
    PathPlace place(times);
    const double in_dwell = std::ceil(run.move.duration() / kH) * kH;
    double waited = 0.0;
    for (int n = 0; n * kH <= run.duration(); ++n) {
      const double t = n * kH, found = place.advance(t, run.at(t));
      if (t < in_dwell) {
        EXPECT_LE(found, arrival + kApproach);
      } else if (t <= run.departure()) {
        EXPECT_NEAR(found, std::min(arrival + (t - in_dwell) / kH, departure), kApproach) << t;
        waited = std::max(waited, found - arrival);
      } else {
        EXPECT_GE(found, departure) << t;
      }
    }
    EXPECT_NEAR(waited, std::min(seconds, kPlanned) / kH, 2.0) << seconds;
    EXPECT_NEAR(place.advance(run.duration() + kH, 2.0 * kL), std::ceil(plan.duration() / kH),
                kApproach);
  }
}

TEST(PathPlace, WaitsAtTheLastInstant) {
  const PathTimes plan = times_of(SCurve(kL, kFeed));
  const auto last = static_cast<double>(plan.s.size() - 1);
  PathPlace place(plan);
  for (int n = 0; n < 2 * static_cast<int>(last); ++n) {
    const auto row = std::min(static_cast<std::size_t>(n), plan.s.size() - 1);
    EXPECT_NEAR(place.advance(n * kH, plan.s[row]), std::min<double>(n, last), kRoundingOfT);
  }
  EXPECT_EQ(place.advance(100.0, 2.0 * kL), last) << "beyond the plan";
}

TEST(PathPlace, KnowsAPlanThatOnlyStands) {
  const PathTimes one{.h = kH, .s = {0.0}}, some{.h = kH, .s = {0.0, 0.0, 0.0}};
  PathPlace at_one(one), at_some(some);
  at_one.advance(0.0, 0.0);
  at_some.advance(0.0, 0.0);
  EXPECT_EQ(at_one.advance(kH, 0.0), 0.0);
  EXPECT_EQ(at_one.advance(2.0 * kH, 1.0), 0.0);
  EXPECT_NEAR(at_some.advance(1.5 * kH, 0.0), 1.5, kRoundingOfT);
  EXPECT_EQ(at_some.advance(9.0 * kH, 0.0), 2.0);
}

// Random plans and runs that stand at any time, in steps of any size.
TEST(PathPlace, NeverGoesBackNorBeyondItsEnd) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    const auto walk = [&](int rows) {
      std::vector<double> s = {0.0};
      for (int n = 1; n < rows; ++n) {
        s.push_back(s.back() + (share(random) < 0.4 ? 0.0 : std::pow(share(random), 8) * 20 * um));
      }
      return s;
    };
    const PathTimes plan{.h = kH, .s = walk(300)};
    PathPlace place(plan);
    double before = 0.0, t = 0.0;
    for (const double s : walk(500)) {
      const double n = place.advance(t, s);
      t += 2.0 * share(random) * kH;
      ASSERT_GE(n, before) << "seed " << seed;
      ASSERT_LE(n, 299.0) << "seed " << seed;
      // between the instants that enclose s
      const auto at = static_cast<std::size_t>(n);
      ASSERT_LE(plan.s[at], std::max(s, plan.s[0]) + kRounding) << "seed " << seed;
      ASSERT_GE(plan.s[std::min<std::size_t>(at + 1, 299)], std::min(s, plan.s.back()) - kRounding)
          << "seed " << seed;
      before = n;
    }
  }
}

}  // namespace
}  // namespace servomill::strategies::path_place_test
