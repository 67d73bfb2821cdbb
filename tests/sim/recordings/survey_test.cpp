#include "sim/recordings/survey.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace servomill::sim::recordings::survey_test {
namespace {

constexpr double kInterval = 0.001;  // s

Base base_without(const std::vector<std::size_t>& missing) {
  Base out;
  for (std::size_t i = 0; i < 100; ++i) {
    if (std::find(missing.begin(), missing.end(), i) != missing.end()) continue;
    out.values.push_back(static_cast<double>(i) * kInterval);
  }
  return out;
}

Channel sine(double limit) {
  Channel out{"x", "A", {}, 0};
  for (int i = 0; i < 400; ++i) {
    const double value = std::sin(2.0 * std::numbers::pi * i / 100.0);
    out.samples.push_back(std::clamp(value, -limit, limit));
  }
  return out;
}

TEST(Survey, GapsAreThereAndNothingElse) {
  EXPECT_TRUE(gaps(base_without({})).empty());
  const auto found = gaps(base_without({10, 11, 12, 50}));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_DOUBLE_EQ(found[0].from, 0.009);
  EXPECT_DOUBLE_EQ(found[0].to, 0.013);
  EXPECT_EQ(found[0].missing, 3u);
  EXPECT_EQ(found[1].missing, 1u);
  EXPECT_NEAR(interval(base_without({10, 11, 12, 50})), kInterval, 1e-15);
}

TEST(Survey, JitterIsTheGreatestDeviationOfAnInterval) {
  Base base = base_without({});
  EXPECT_LT(jitter(base), 1e-9);
  base.values[40] += 0.2 * kInterval;
  EXPECT_NEAR(jitter(base), 0.2, 1e-9);
}

TEST(Survey, ClippedSineIsClippedOnBothSidesAndAFullOneOnNone) {
  EXPECT_TRUE(clipping(sine(2.0)).empty());
  const auto found = clipping(sine(0.9));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].level, -0.9);
  EXPECT_EQ(found[1].level, 0.9);
  // asin(0.9) is 17.8 of 100 samples: 18 to 32 are at the limit
  EXPECT_EQ(found[1].runs, 4u);
  EXPECT_EQ(found[1].samples, 60u);
  EXPECT_EQ(found[1].first, 18u);
}

TEST(Survey, PositionAtRestAtTheEndOfItsTravelIsNotClipped) {
  constexpr double kQuantum = 5e-8;  // m
  Channel position{"x", "m", {}, 0};
  for (int i = 0; i < 400; ++i) {
    const double phase = std::clamp((i - 100) / 200.0, 0.0, 1.0);
    const double travel = 0.1 * (1.0 - std::cos(std::numbers::pi * phase));
    position.samples.push_back(std::round(travel / kQuantum) * kQuantum);
  }
  EXPECT_TRUE(clipping(position).empty());
}

TEST(Survey, ConstantsAndMissingSamplesAreNotClipped) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(clipping({"x", "", {1, 1, 1, 1}, 0}).empty());
  EXPECT_TRUE(clipping({"x", "", {nan, nan, nan, nan}, 0}).empty());
  EXPECT_EQ(missing_samples({"x", "", {1, nan, 2, nan}, 0}), 2u);
}

TEST(Survey, TextNamesEverything) {
  Recording recording{"a.csv", "CSV", {base_without({10})}, {}, {"a note"}};
  Channel channel{"x", "mm", std::vector<double>(99, 1.0), 0};
  channel.samples[3] = std::numeric_limits<double>::quiet_NaN();
  recording.channels.push_back(channel);
  const std::string text = survey(recording);
  EXPECT_NE(text.find("a.csv: CSV\n  time: 99 samples, 0 to 0.099 s, every 1 ms (1000 Hz)\n"
                      "    gap: 0.009 to 0.011 s, 1 sample missing\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("note: a note"), std::string::npos);
}

}  // namespace
}  // namespace servomill::sim::recordings::survey_test
