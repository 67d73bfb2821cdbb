#include "sim/recordings/recording.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/text.h"

namespace servomill::sim::recordings::recording_test {
namespace {

Recording right() {
  return {"a.h5", "", {{"time", "s", {0.0, 0.5, 1.0}}}, {{"x", "mm", {1, 2, 3}, 0}}, {}};
}

std::string refusal(const Recording& recording) {
  return fault_messages([&] { check(recording); });
}

TEST(Check, LawsOfARecording) {
  EXPECT_EQ(refusal(right()), "");
  Recording wrong = right();
  wrong.channels[0].samples.pop_back();
  EXPECT_EQ(refusal(wrong), "channel 'x' has 2 samples, its time has 3 values\n");
  wrong = right();
  wrong.channels[0].samples[1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal(wrong), "channel 'x' is infinite at time 0.5 s\n");
  wrong = right();
  wrong.bases[0].values[2] = 0.25;
  EXPECT_EQ(refusal(wrong), "time: value 3 is 0.25 s after 0.5 s; must increase\n");
  wrong = right();
  wrong.channels.push_back(wrong.channels[0]);
  EXPECT_EQ(refusal(wrong), "channels 1 and 2 are both called 'x'\n");
  wrong = right();
  wrong.channels.clear();
  EXPECT_EQ(refusal(wrong), "contains no channel\n");
  wrong = right();
  wrong.bases[0].values[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(wrong), "time: value 1 is not finite\n");
}

TEST(TimeUnit, IsForTimesWithoutOneOnly) {
  Recording recording = right();
  EXPECT_EQ(fault_messages([&] { set_time_unit(recording, "us"); }),
            "has a unit for every time; --time-unit does not apply\n");
  recording.bases[0].unit_known = false;
  EXPECT_EQ(fault_messages([&] { set_time_unit(recording, "mm"); }),
            "'mm' is not a unit of time; known are s, ms, us, ns, min and h\n");
  set_time_unit(recording, "ms");
  EXPECT_EQ(recording.bases[0].values[1], 0.5e-3);
  recording = right();
  recording.bases[0].unit_known = false;
  set_time_unit(recording, "");
  EXPECT_EQ(recording.bases[0].values, right().bases[0].values);
  EXPECT_EQ(recording.notes.at(0),
            "the file has no unit of its time: s is assumed; --time-unit specifies another");
}

}  // namespace
}  // namespace servomill::sim::recordings::recording_test
