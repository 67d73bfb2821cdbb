#include "sim/recordings/csv_reader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::recordings::csv_reader_test {
namespace {

std::string refusal(std::string_view text) {
  try {
    parse_csv(text, "a.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CsvReader, SignsAreRecognised) {
  struct Case {
    const char* text;
    const char* format;
  };
  for (const Case& one :
       {Case{"t [ms];x [mm]\n0;1,5\n1;2,5\n", "CSV, separator ';', decimal ','"},
        Case{"t [ms];x [mm]\n0;1.5\n1;2.5\n", "CSV, separator ';', decimal '.'"},
        Case{"t [ms],x [mm]\n0,1.5\n1,2.5\n", "CSV, separator ',', decimal '.'"},
        Case{"t [ms]\tx [mm]\n0\t1,5\n1\t2,5\n", "CSV, separator tab, decimal ','"},
        Case{"t [ms]\tx [mm]\n0\t1.5\n1\t2.5\n", "CSV, separator tab, decimal '.'"}}) {
    const Recording recording = parse_csv(one.text, "a.csv");
    EXPECT_EQ(recording.format, one.format);
    ASSERT_EQ(recording.channels.size(), 1u) << one.text;
    EXPECT_EQ(recording.channels[0].name, "x");
    EXPECT_EQ(recording.channels[0].unit, "mm");
    EXPECT_EQ(recording.channels[0].samples, (std::vector<double>{1.5, 2.5}));
    EXPECT_EQ(recording.bases[0].values, (std::vector<double>{0.0, 0.001}));
  }
}

TEST(CsvReader, NamesMayEndWithTheirUnit) {
  const Recording recording = parse_csv("time_ms,X_mm\n0,1.5\n1,2.5\n", "a.csv");
  ASSERT_EQ(recording.channels.size(), 1u);
  EXPECT_EQ(recording.channels[0].name, "X_mm");
  EXPECT_EQ(recording.channels[0].unit, "mm");
  EXPECT_TRUE(recording.bases[0].unit_known);
  EXPECT_EQ(recording.bases[0].values, (std::vector<double>{0.0, 0.001}));
}

TEST(CsvReader, BlanksSeparateAndACommentMayBeTheHeading) {
  const Recording recording = parse_csv("# made by numpy\n# time x\n0.0 1e-3\n0.5 2e-3\n", "a");
  EXPECT_EQ(recording.channels.at(0).name, "x");
  EXPECT_EQ(recording.channels[0].samples, (std::vector<double>{1e-3, 2e-3}));
}

TEST(CsvReader, OneColumnWithCommasIsNotTwo) {
  const Recording recording = parse_csv("x\n1,5\n2,5\n", "a");
  ASSERT_EQ(recording.channels.size(), 1u);
  EXPECT_EQ(recording.channels[0].samples, (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(recording.bases[0].unit, "1");
}

TEST(CsvReader, UnitsMayHaveALineOfTheirOwnUnderAHeadOfText) {
  const Recording recording =
      parse_csv("Machine: M7\nOperator;N. N.\n\nTime;I ist\nms;A\n0;1\n2;3\n", "a");
  EXPECT_EQ(recording.channels.at(0).name, "I ist");
  EXPECT_EQ(recording.channels[0].unit, "A");
  EXPECT_EQ(recording.bases[0].values, (std::vector<double>{0.0, 0.002}));
}

TEST(CsvReader, EmptyFieldsAndNaNAreMissingSamples) {
  const Recording recording = parse_csv("t [s],x,y\n0,1,2\n1,,3\n2,nan,4\n", "a");
  EXPECT_TRUE(std::isnan(recording.channels.at(0).samples[1]));
  EXPECT_TRUE(std::isnan(recording.channels[0].samples[2]));
  EXPECT_EQ(recording.channels[1].samples, (std::vector<double>{2, 3, 4}));
}

TEST(CsvReader, WithoutHeadingColumnsAreNumbered) {
  const Recording recording = parse_csv("1,2\n3,4\n", "a");
  EXPECT_EQ(recording.channels.at(1).name, "column 2");
  EXPECT_EQ(recording.bases[0].name, "sample");
}

TEST(CsvReader, RefusesWithLineAndColumn) {
  EXPECT_EQ(refusal("t,x\n0,1\n1,2,3\n2,3\n"), "a.csv:3: error: 3 fields in a table of 2 columns");
  EXPECT_EQ(
      refusal("t,x,y\n0,1,2\n1,2,3\n2,"),
      "a.csv:4: error: 2 fields in a table of 3 columns, and the file ends here: it is truncated");
  EXPECT_EQ(refusal("t,x\n0,1\n1,abc\n2,3\n"), "a.csv:3:3: error: 'abc' is not a number");
  EXPECT_EQ(refusal("t,x\n0,abc\n1,2\n2,3\n"), "a.csv:2:3: error: 'abc' is not a number");
  EXPECT_EQ(refusal("t,x\n0,1\n2,2\n1,3\n"), "a.csv:4: error: time runs backwards: 1 s after 2 s");
  EXPECT_EQ(refusal("t,x\n0,1\n1,2\n1,3\n"), "a.csv:4: error: time 1 s appears twice");
  EXPECT_EQ(refusal("t,x\n0,1\n,2\n1,3\n"), "a.csv:3: error: has no time");
  EXPECT_EQ(refusal("t,x,x\n0,1,2\n"), "a.csv:1:5: error: columns 2 and 3 are both called 'x'");
  EXPECT_EQ(refusal("t,x\n0,1\n1,1e400\n"), "a.csv:3:3: error: '1e400' is infinite");
  EXPECT_EQ(refusal("t [mm],x\n0,1\n"),
            "a.csv:1:1: error: 'mm' is not a unit of time; known are s, ms, us, ns, min and h");
  EXPECT_EQ(refusal("hello\nworld\n"), "a.csv: error: contains no row of numbers");
  EXPECT_EQ(refusal("t\n1\n2\n"), "a.csv: error: contains no channel");
}

}  // namespace
}  // namespace servomill::sim::recordings::csv_reader_test
