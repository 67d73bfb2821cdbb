#include "sim/model/schedule.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <random>

#include "tests/sim/small_scenario.h"

namespace servomill::sim::model::schedule_test {
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
      EXPECT_TRUE(n == total * round || instant.due != kErrorModel) << "that is a stop";
      const auto see = [&](std::uint8_t due, Tick now) {
        for (std::size_t i = 0; i < rates.size(); ++i) {
          if (due & rates[i].due) seen[i].push_back(now);
        }
      };
      see(instant.due, n);
      Tick before = 0;
      for (const Tick stop : instant.stops) {
        EXPECT_GT(stop, before);
        EXPECT_LT(stop, instant.step);
        see(kErrorModel, n + stop);
        before = stop;
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
  expect_due_exactly_at_its_multiples({{kPositionLoop, 20, 0},
                                       {kVelocityLoop, 20, 0},
                                       {kCurrentLoop, 10, 0},
                                       {kErrorModel, 6, 0},
                                       {kFeedbackSample, 20, 19},
                                       {kRecord, 100, 0}});
}

TEST(Schedule, VisitsEveryRateAtItsMultiplesForRandomPeriods) {
  std::mt19937 random(23);
  for (int n = 0; n < 200; ++n) {
    std::vector<Rate> rates = {{kPositionLoop, static_cast<Tick>(1 + random() % 12), 0}};
    for (const std::uint8_t due :
         {kErrorModel, kFeedbackSample, kVelocityLoop, kCurrentLoop, kRecord}) {
      const auto period = static_cast<Tick>(1 + random() % 12);
      rates.push_back({due, period, static_cast<Tick>(random()) % period});
    }
    expect_due_exactly_at_its_multiples(rates);
  }
}

// CC424 with a reading that is taken one tick before the position loop.
TEST(Schedule, TakesOneStepOverWhatNobodyNeeds) {
  const std::vector<Rate> rates = {
      {kPositionLoop, 20, 0}, {kCurrentLoop, 10, 0}, {kFeedbackSample, 20, 19}};
  const std::vector<Instant> schedule = make_schedule(rates);
  ASSERT_EQ(schedule.size(), 3U);
  EXPECT_EQ(schedule[0].due, kPositionLoop | kCurrentLoop);
  EXPECT_EQ(schedule[0].step, 10);
  EXPECT_EQ(schedule[1].due, kCurrentLoop);
  EXPECT_EQ(schedule[1].step, 9);
  EXPECT_EQ(schedule[2].due, kFeedbackSample);
  EXPECT_EQ(schedule[2].step, 1);
}

TEST(Hyperperiod, IsTheLeastCommonMultipleUpToItsLimit) {
  EXPECT_EQ(hyperperiod({{kPositionLoop, 20}, {kErrorModel, 6}, {kRecord, 100}}), 300);
  EXPECT_EQ(hyperperiod({{kPositionLoop, kMaxHyperperiod}}), kMaxHyperperiod);
  EXPECT_EQ(hyperperiod({{kPositionLoop, kMaxHyperperiod + 1}}), 0);
  EXPECT_EQ(hyperperiod({{kPositionLoop, 1000}, {kRecord, 999}}), 999'000);
  EXPECT_EQ(hyperperiod({{kPositionLoop, 1001}, {kRecord, 1000}}), 0);
  EXPECT_EQ(hyperperiod({{kPositionLoop, 7}, {kRecord, std::numeric_limits<Tick>::max()}}), 0);
}

// 999.99 ms are 99999 ticks: with position periods of 20 ticks, only every 20 s are both due at
// once.
TEST(ReadScenario, RefusesPeriodsThatHardlyEverMeet) {
  try {
    small_scenario("G1 X1 F600\nM30\n", "[record]\nperiod_ms = 999.99\n[[case]]\nname = \"one\"\n");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(), SERVOMILL_SOURCE_DIR
        "/scenarios/small.toml:2:1: error: record: the common period of the loops, the error model "
        "and the recorder exceeds 10 s; make the periods multiples of each other");
  }
  EXPECT_NO_THROW(small_scenario("G1 X1 F600\nM30\n",
                                 "[record]\nperiod_ms = 1000.0\n[[case]]\nname = \"one\"\n"));
}

}  // namespace
}  // namespace servomill::sim::model::schedule_test
