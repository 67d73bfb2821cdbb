#include "sim/recordings/camonitor_reader.h"

#include <gtest/gtest.h>

#include "tests/text.h"

namespace servomill::sim::recordings::camonitor_reader_test {
namespace {

using Values = std::vector<double>;

const std::string kFirst = "ax:pos                         2024-02-29 23:59:59.500000 1.5  \n";

std::string refusal(const std::string& text) {
  try {
    parse_camonitor(text, "a.txt");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Camonitor, VariablesHaveTheirOwnTimes) {
  const std::string text = kFirst + "ax:cur 2024-03-01 00:00:00.000000 4 HIGH MINOR\n" +
                           "ax:pos 2024-03-01 00:00:00.250000 -2e-3  \n";
  EXPECT_TRUE(is_camonitor(text));
  const Recording recording = parse_camonitor(text, "a.txt");
  ASSERT_EQ(recording.channels.size(), 2u);
  EXPECT_EQ(recording.channels[0].name, "ax:pos");
  EXPECT_EQ(recording.channels[0].samples, (Values{1.5, -0.002}));
  EXPECT_EQ(recording.bases[0].values, (Values{0.0, 0.75}));
  EXPECT_EQ(recording.channels[1].samples, (Values{4.0}));
  EXPECT_EQ(recording.bases[recording.channels[1].base].values, (Values{0.5}));
  EXPECT_EQ(recording.notes, (std::vector<std::string>{"'ax:cur': 1 sample with an alarm",
                                                       "time 0 is 2024-02-29 23:59:59.500000"}));
}

TEST(Camonitor, WhatIsNoNumberOrHasNoTimeIsNoted) {
  const std::string text =
      "lost *** Not connected (PV not found)\nnew <undefined> 0 UDF INVALID\n" + kFirst + kFirst +
      "mode 2024-03-01 00:00:00 Idle\n" + "wave 2024-03-01 00:00:00 3 1 2 3\n" +
      "ax:pos 2024-03-01 00:00:01 *** disconnected\n";
  EXPECT_TRUE(is_camonitor(text));
  const Recording recording = parse_camonitor(text, "a.txt");
  ASSERT_EQ(recording.channels.size(), 1u);
  EXPECT_EQ(recording.channels[0].samples, (Values{1.5}));
  EXPECT_EQ(recording.notes,
            (std::vector<std::string>{
                "'new': 1 line without a time: skipped", "'ax:pos': 1 line repeated",
                "'mode': a text or an array: skipped", "'wave': a text or an array: skipped",
                "2 messages of lost or missing connections (***): values may be missing there",
                "time 0 is 2024-02-29 23:59:59.500000"}));
}

TEST(Camonitor, BadInput) {
  EXPECT_EQ(refusal(kFirst + "ax:pos 2024-02-29 23:59:58.500000 1\n"),
            "a.txt:2: error: time runs backwards: -1 s after 0 s");
  EXPECT_EQ(refusal(kFirst + "ax:pos 2024-02-29 23:59:59.500000 2\n"),
            "a.txt:2: error: time 0 s appears twice");
  EXPECT_EQ(refusal(kFirst + "ax:pos 2024-02-30 00:00:00 2\n"),
            "a.txt:2:8: error: '2024-02-30 00:00:00' is not a date and time");
  EXPECT_EQ(refusal(kFirst + "ax:pos 2024-03-01 00:00:00 off\n"),
            "a.txt:2:28: error: 'off' is not a number");
  EXPECT_EQ(refusal(kFirst + "ax:pos 2024-03-01 00:00:00 1 2\n"),
            "a.txt:2:30: error: '2' after the value is not a status with severity");
  EXPECT_EQ(refusal(kFirst + "ax:pos 2024-03-01\n"),
            "a.txt:2: error: is not a line of variable, date, time and value");
  EXPECT_EQ(refusal(kFirst + "ax:pos 2024-03-01 00:00:00 1"),
            "a.txt:2: error: the file ends within a line: it is truncated");
  EXPECT_EQ(refusal("mode 2024-03-01 00:00:00 Idle\n"), "a.txt: error: contains no channel");
}

TEST(Camonitor, OtherTextsAreNone) {
  EXPECT_FALSE(is_camonitor("t x\n0 1\n"));
  EXPECT_FALSE(is_camonitor("x *** y\n"));
}

}  // namespace
}  // namespace servomill::sim::recordings::camonitor_reader_test
