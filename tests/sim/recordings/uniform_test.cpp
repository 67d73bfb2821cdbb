#include "sim/recordings/uniform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/text.h"

namespace servomill::sim::recordings::uniform_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kRounding = 1e-14;  // of values up to 10, a few operations
using Values = std::vector<double>;

Recording recording_of(Values times, Values samples, const std::string& unit = "s") {
  Recording out{"a.csv", "CSV", {Base{"time", unit, std::move(times)}}, {}, {}};
  out.channels.push_back({"position", "mm", std::move(samples), 0});
  return out;
}

std::string refusal(const Recording& recording, const std::string& name, double period,
                    double longest) {
  return fault_messages([&] { uniform_channel(recording, name, period, longest); });
}

TEST(UniformChannel, OwnInstantsAreUnchangedBitForBit) {
  Values times, samples;
  for (int i = 0; i < 1000; ++i) {
    times.push_back(i / 1000.0);
    samples.push_back(std::sin(0.1 * i));
  }
  const UniformChannel uniform =
      uniform_channel(recording_of(times, samples), "position", 1e-3, 0.01);
  EXPECT_EQ(uniform.samples, samples);
  EXPECT_EQ(uniform.unit, "mm");
  EXPECT_TRUE(uniform.missing.empty());
}

TEST(UniformChannel, AStraightLineStaysOneWhateverTheInstants) {
  const Values times = {0.5, 0.7, 1.1, 1.2, 1.9, 2.0};
  Values samples;
  for (const double t : times) samples.push_back(3.0 - 2.0 * t);
  const UniformChannel uniform =
      uniform_channel(recording_of(times, samples), "position", 0.13, 1.0);
  EXPECT_EQ(uniform.samples.size(), 12u);  // 0.5 to 1.93
  for (std::size_t k = 0; k < uniform.samples.size(); ++k) {
    EXPECT_NEAR(uniform.samples[k], 3.0 - 2.0 * (0.5 + 0.13 * static_cast<double>(k)), kRounding);
  }
}

TEST(UniformChannel, ErrorOfAParabolaIsThatOfTheChord) {
  // between samples h apart the chord of t^2 lies h^2 / 4 above its middle
  const Values times = {0.0, 0.2, 0.4, 0.6};
  Values samples;
  for (const double t : times) samples.push_back(t * t);
  const UniformChannel uniform =
      uniform_channel(recording_of(times, samples), "position", 0.1, 1.0);
  ASSERT_EQ(uniform.samples.size(), 7u);
  for (std::size_t k = 0; k < 7; ++k) {
    const double t = 0.1 * static_cast<double>(k);
    EXPECT_NEAR(uniform.samples[k] - t * t, k % 2 == 1 ? 0.01 : 0.0, kRounding);
  }
}

TEST(UniformChannel, MissingSamplesAreIntervals) {
  const Recording recording =
      recording_of({0, 1, 2, 3, 4, 5, 8, 9}, {kNan, 1, kNan, kNan, 4, 5, 8, kNan});
  const UniformChannel uniform = uniform_channel(recording, "position", 1.0, 3.0);
  EXPECT_EQ(uniform.start, 1.0);
  EXPECT_EQ(uniform.samples, (Values{1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(uniform.missing, (std::vector<Interval>{{1, 4}, {5, 8}}));
}

TEST(UniformChannel, AGapIsBridgedUpToTheTimeAllowed) {
  const Recording recording = recording_of({0, 1, 2, 5, 6}, {0, 1, 2, 5, 6});
  EXPECT_EQ(uniform_channel(recording, "position", 1.0, 3.0).samples.size(), 7u);
  EXPECT_EQ(refusal(recording, "position", 1.0, 2.9),
            "channel 'position' has no sample between time 2 s and 5 s; at most 2.9 s may be "
            "bridged\n");
}

TEST(UniformChannel, BadInput) {
  const Recording recording = recording_of({0, 1}, {0, 1});
  EXPECT_EQ(refusal(recording, "postion", 1.0, 9.0),
            "has no channel 'postion'; did you mean 'position'?\n");
  EXPECT_EQ(refusal(recording, "current", 1.0, 9.0), "has no channel 'current'\n");
  EXPECT_EQ(refusal(recording_of({0, 1}, {0, 1}, "1"), "position", 1.0, 9.0),
            "channel 'position' has no times: its base is sample numbers\n");
  EXPECT_EQ(refusal(recording_of({0, 1}, {0, 1}, "Hz"), "position", 1.0, 9.0),
            "channel 'position' has no times: its base is in Hz\n");
  EXPECT_EQ(refusal(recording_of({0, 1}, {kNan, kNan}), "position", 1.0, 9.0),
            "channel 'position' has no sample\n");
  EXPECT_EQ(refusal(recording, "position", 1e-9, 9.0),
            "channel 'position': 1 s in periods of 1e-09 s are more than 1e8 samples\n");
}

}  // namespace
}  // namespace servomill::sim::recordings::uniform_test
