#include "controllers/gcode/repeated_words.h"

#include <gtest/gtest.h>

#include <string>

namespace servomill::controllers::repeated_words_test {
namespace {

// The line that is left, and the column of the rule.
std::string left(const std::string& text, Reader reader = Reader::any) {
  TolerantLine line{text, {}, {}};
  drop_repeated_words(line, reader);
  std::string out = line.text;
  for (const AppliedRule& one : line.applied) out += "|" + std::to_string(one.column);
  return out;
}

TEST(RepeatedWords, TheLastFeedAndSpeedCount) {
  EXPECT_EQ(left("G1F300 X1.F600.5"), "G1     X1.F600.5|11");
  EXPECT_EQ(left("S100 s 200 M3"), "     s 200 M3|6");
  EXPECT_EQ(left("F1 F2 F3 (F4)"), "      F3 (F4)|4");
}

TEST(RepeatedWords, OthersOnlyWithTheSameNumber) {
  EXPECT_EQ(left("G0 X1. Y2 X+1.00"), "G0     Y2 X+1.00|11");
  EXPECT_EQ(left("T1 M6 T2"), "T1 M6 T2");
  EXPECT_EQ(left("G0 X1 X2"), "G0 X1 X2");
}

TEST(RepeatedWords, StayWhereTheyAreNoNumbersOrTheControlRefusesThem) {
  EXPECT_EQ(left("F#1 F2"), "F#1 F2");
  EXPECT_EQ(left("G1 F5 F6", Reader::grbl), "G1 F5 F6");
  EXPECT_EQ(left("G90 G90 M8 M8"), "G90 G90 M8 M8");
  EXPECT_EQ(left("F5 ; F6"), "F5 ; F6");
}

}  // namespace
}  // namespace servomill::controllers::repeated_words_test
