#include "sim/recordings/tncscope_reader.h"

#include <gtest/gtest.h>

#include "tests/text.h"

namespace servomill::sim::recordings::tncscope_reader_test {
namespace {

using Values = std::vector<double>;

std::string curve(int number, const std::string& type, int count, int cycle) {
  return "%[CURVE" + std::to_string(number) + "]\n%CHANNELTYPE=" + type +
         "\n%AXISTYPE=X\n%DIMENSION=mm\n%COUNT=" + std::to_string(count) +
         "\n%CYCLETIME=" + std::to_string(cycle) + "\n";
}

const std::string kHead = "%[GLOBAL]\n%VERSION=1\n";
const std::string kOne = kHead + curve(1, "s actual", 2, 3000) + "%[DATA]\n";  // data: line 9 on

std::string refusal(const std::string& text) {
  try {
    parse_tncscope(text, "a.sco");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Tncscope, CurvesWithUnitsAndTimesInMicroseconds) {
  const std::string text = kOne + "0;1,5\n3000;-2,25\n";
  EXPECT_TRUE(is_tncscope(text));
  const Recording recording = parse_tncscope(text, "a.sco");
  ASSERT_EQ(recording.channels.size(), 1u);
  EXPECT_EQ(recording.channels[0].name, "s actual X");
  EXPECT_EQ(recording.channels[0].unit, "mm");
  EXPECT_EQ(recording.channels[0].samples, (Values{1.5, -2.25}));
  EXPECT_EQ(recording.bases[0].values, (Values{0.0, 3000 * 1e-6}));
  EXPECT_TRUE(recording.bases[0].unit_known);
}

TEST(Tncscope, SlowerCurvesHaveABaseOfTheirOwn) {
  const Recording recording =
      parse_tncscope(kHead + curve(1, "s actual", 3, 3000) + curve(2, "i act.", 2, 6000) +
                         "%[DATA]\n0;1;7\n3000;2;\n6000;3;8\n",
                     "a.sco");
  ASSERT_EQ(recording.channels.size(), 2u);
  EXPECT_EQ(recording.channels[1].samples, (Values{7, 8}));
  EXPECT_EQ(recording.bases[recording.channels[1].base].values, (Values{0.0, 6000 * 1e-6}));
  EXPECT_EQ(recording.bases[recording.channels[0].base].values.size(), 3u);
}

TEST(Tncscope, BadInput) {
  EXPECT_EQ(refusal(kHead),
            "a.sco: error: has no section %[DATA]: it is truncated or of another kind");
  EXPECT_EQ(refusal(kHead + "%[DATA]\n"), "a.sco: error: contains no channel");
  EXPECT_EQ(
      refusal(kOne + "0;1\n"),
      "a.sco:3: error: channel 's actual X' has 1 sample, its %COUNT is 2: the file is truncated");
  EXPECT_EQ(refusal(kOne + "0;1\n3000;2\n6000;3\n"),
            "a.sco:3: error: channel 's actual X' has 3 samples, its %COUNT is 2");
  EXPECT_EQ(
      refusal(kOne + "0;1\n3000"),
      "a.sco:11: error: 1 field for a time and 1 curve, and the file ends here: it is truncated");
  EXPECT_EQ(refusal(kOne + "0;1;2\n3000;2\n"), "a.sco:10: error: 3 fields for a time and 1 curve");
  EXPECT_EQ(refusal(kOne + "0;1\n3000;on\n"), "a.sco:11:6: error: 'on' is not a number");
  EXPECT_EQ(refusal(kOne + "3000000;1\n0;2\n"),
            "a.sco:11: error: time runs backwards: 0 s after 3 s");
  EXPECT_EQ(refusal(kOne + "0;1\n0;2\n"), "a.sco:11: error: time 0 s appears twice");
  EXPECT_EQ(refusal(kOne + "0;1\n;2\n"), "a.sco:11: error: has no time");
  EXPECT_EQ(refusal(kHead + "%[CURVE1]\n%COUNT=two\n%[DATA]\n0;1\n"),
            "a.sco:3: error: %COUNT is 'two', which is not a number");
}

TEST(TncscopeCsv, TimeIsInMicroseconds) {
  const std::string text = "time;s actual X;i ist X\n0;1,5;2\n2000;2,5;3\n";
  EXPECT_TRUE(is_tncscope_csv(text));
  const Recording recording = parse_tncscope_csv(text, "a.csv");
  EXPECT_EQ(recording.format, "TNCscope CSV, separator ';', decimal ','");
  EXPECT_EQ(recording.bases[0].values, (Values{0.0, 2000 * 1e-6}));
  EXPECT_TRUE(recording.bases[0].unit_known);
}

TEST(TncscopeCsv, AUnitInTheFileCountsAndOtherTablesAreNone) {
  const std::string text = "time [ms];s dif X\n0;1\n2;3\n";
  EXPECT_EQ(parse_tncscope_csv(text, "a.csv").bases[0].values, (Values{0.0, 2 * 1e-3}));
  EXPECT_FALSE(is_tncscope_csv("time;x\n0;1\n"));
}

}  // namespace
}  // namespace servomill::sim::recordings::tncscope_reader_test
