#include "sim/recordings/twincat_reader.h"

#include <gtest/gtest.h>

#include "tests/text.h"

namespace servomill::sim::recordings::twincat_reader_test {
namespace {

using Values = std::vector<double>;

// Two groups: position and its command every 2 ms, the current every 4 ms.
const std::string kHead =
    "Name\tProject\nStarttime of export\t133000000000000000\n\n"
    "Name\tpos\tcmd\tName\tcur\n"
    "SampleTime[ms]\t2\t2\tSampleTime[ms]\t4\n"
    "SymbolName\tMAIN.pos\tMAIN.cmd\tSymbolName\tMAIN.cur\n"
    "Offset\t0\t0\tOffset\t2\n"
    "Unit\tmm\t(None)\tUnit\tA\n\n";  // rows: line 10 on

std::string refusal(const std::string& text) {
  try {
    parse_twincat(text, "a.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_both_groups(const Recording& recording) {
  ASSERT_EQ(recording.channels.size(), 3u);
  EXPECT_EQ(recording.channels[0].name, "MAIN.pos");
  EXPECT_EQ(recording.channels[0].unit, "mm");
  EXPECT_EQ(recording.channels[0].samples, (Values{0.5, 1.5, 2.5}));
  EXPECT_EQ(recording.channels[1].unit, "");
  EXPECT_EQ(recording.bases[recording.channels[1].base].values, (Values{0.0, 2 / 1e3, 4 / 1e3}));
  EXPECT_EQ(recording.channels[2].name, "MAIN.cur");
  EXPECT_EQ(recording.channels[2].samples, (Values{7, 8}));
  EXPECT_EQ(recording.bases[recording.channels[2].base].values, (Values{0.0, 4 / 1e3}));
}

TEST(Twincat, GroupsHaveTheirOwnTimes) {
  const std::string text = kHead + "0\t0,5\t1\t0\t7\n2\t1,5\t1\t4\t8\n4\t2,5\t1\nEOF\n";
  EXPECT_TRUE(is_twincat(text));
  expect_both_groups(parse_twincat(text, "a.csv"));
  EXPECT_TRUE(parse_twincat(text, "a.csv").notes.empty());
}

TEST(Twincat, RowsThatAreRepeatedAreTakenOnce) {
  const Recording recording =
      parse_twincat(kHead + "0\t0,5\t1\t0\t7\n2\t1,5\t1\t0\t7\n4\t2,5\t1\t4\t8\n", "a.csv");
  expect_both_groups(recording);
  EXPECT_EQ(recording.notes,
            std::vector<std::string>{"'MAIN.cur': 1 row repeated by the export, taken once"});
}

TEST(Twincat, NamesAlone) {
  const Recording recording = parse_twincat("Name,a,Name,b\n0,1.5,0,2\n1,2.5,1,3\n", "a.csv");
  ASSERT_EQ(recording.channels.size(), 2u);
  EXPECT_EQ(recording.channels[0].samples, (Values{1.5, 2.5}));
  EXPECT_EQ(recording.bases.size(), 1u);  // equal times are one base
  EXPECT_FALSE(is_twincat("t,x\n0,1\n"));
}

TEST(Twincat, TimeThatIsNotTheSampleTimeIsNoted) {
  EXPECT_EQ(parse_twincat("Name;x\nSampleTime[ms];0,5\n0;1\n1;2\n", "a.csv").notes,
            std::vector<std::string>{
                "the time of 'x' advances by 1 ms per sample, its SampleTime is 0,5 ms"});
}

TEST(Twincat, BadInput) {
  const std::string row = "0\t0,5\t1\t0\t7\n";
  EXPECT_EQ(refusal(kHead), "a.csv: error: contains no row of numbers under a line 'Name'");
  EXPECT_EQ(refusal(kHead + row + "2\t0,5\n"),
            "a.csv:11: error: 2 fields in a table of 5 columns: the row is truncated");
  EXPECT_EQ(refusal(kHead + row + "2\t0,5\t1\t4\t8\t9\n"),
            "a.csv:11: error: 6 fields in a table of 5 columns");
  EXPECT_EQ(refusal(kHead + row + "2\ton\t1\t4\t8\n"), "a.csv:11:3: error: 'on' is not a number");
  EXPECT_EQ(refusal(kHead + row + "2\t1\t1\t-4\t8\n"),
            "a.csv:11:7: error: time runs backwards: -0.004 s after 0 s");
  EXPECT_EQ(refusal(kHead + row + "2\t1\t1\t0\t8\n"), "a.csv:11:7: error: time 0 s appears twice");
  EXPECT_EQ(refusal(kHead + row + "\t1\t1\t4\t8\n"), "a.csv:11:1: error: has no time");
}

}  // namespace
}  // namespace servomill::sim::recordings::twincat_reader_test
