#include "sim/schedule.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace servomill::sim {
namespace {

// Walks the schedule over several common multiples and notes when each rate was due.
void expect_due_exactly_at_its_multiples(const std::vector<Rate>& rates) {
  const Tick total = hyperperiod(rates);
  const std::vector<Instant> schedule = make_schedule(rates);
  std::vector<std::vector<Tick>> seen(rates.size());
  Tick n = 0;
  for (int round = 0; round < 3; ++round) {
    for (const Instant& instant : schedule) {
      EXPECT_GT(instant.step, 0);
      EXPECT_NE(instant.due, 0) << "nothing is visited that is not due";
      for (std::size_t i = 0; i < rates.size(); ++i) {
        if (instant.due & rates[i].due) seen[i].push_back(n);
      }
      n += instant.step;
    }
    ASSERT_EQ(n, total * (round + 1));
  }
  for (std::size_t i = 0; i < rates.size(); ++i) {
    std::vector<Tick> wanted;
    for (Tick t = rates[i].phase; t < n; t += rates[i].period) wanted.push_back(t);
    EXPECT_EQ(seen[i], wanted) << "rate " << i << " of period " << rates[i].period;
  }
}

TEST(Schedule, VisitsEveryRateAtItsMultiples) {
  expect_due_exactly_at_its_multiples({{kPosition, 20, 0},
                                       {kVelocity, 20, 0},
                                       {kCurrent, 10, 0},
                                       {kErrorModel, 6, 0},
                                       {kSample, 20, 19},
                                       {kRecord, 100, 0}});
}

TEST(Schedule, VisitsEveryRateAtItsMultiplesForRandomPeriods) {
  std::mt19937 random(23);
  for (int n = 0; n < 200; ++n) {
    std::vector<Rate> rates = {{kPosition, static_cast<Tick>(1 + random() % 12), 0}};
    for (const std::uint8_t due : {kErrorModel, kSample, kVelocity, kCurrent, kRecord}) {
      const auto period = static_cast<Tick>(1 + random() % 12);
      rates.push_back({due, period, static_cast<Tick>(random()) % period});
    }
    expect_due_exactly_at_its_multiples(rates);
  }
}

// CC424 with a reading that is taken one tick before the position loop.
TEST(Schedule, TakesOneStepOverWhatNobodyNeeds) {
  const std::vector<Rate> rates = {{kPosition, 20, 0}, {kCurrent, 10, 0}, {kSample, 20, 19}};
  const std::vector<Instant> schedule = make_schedule(rates);
  ASSERT_EQ(schedule.size(), 3U);
  EXPECT_EQ(schedule[0].due, kPosition | kCurrent);
  EXPECT_EQ(schedule[0].step, 10);
  EXPECT_EQ(schedule[1].due, kCurrent);
  EXPECT_EQ(schedule[1].step, 9);
  EXPECT_EQ(schedule[2].due, kSample);
  EXPECT_EQ(schedule[2].step, 1);
}

TEST(Hyperperiod, IsTheLeastCommonMultipleUpToItsLimit) {
  EXPECT_EQ(hyperperiod({{kPosition, 20}, {kErrorModel, 6}, {kRecord, 100}}), 300);
  EXPECT_EQ(hyperperiod({{kPosition, kMaxHyperperiod}}), kMaxHyperperiod);
  EXPECT_EQ(hyperperiod({{kPosition, kMaxHyperperiod + 1}}), 0);
  EXPECT_EQ(hyperperiod({{kPosition, 1000}, {kRecord, 999}}), 999'000);
  EXPECT_EQ(hyperperiod({{kPosition, 1001}, {kRecord, 1000}}), 0);
}

}  // namespace
}  // namespace servomill::sim
