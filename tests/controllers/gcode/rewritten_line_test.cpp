#include "controllers/gcode/rewritten_line.h"

#include <gtest/gtest.h>

namespace servomill::controllers::rewritten_line_test {
namespace {

// "G4 X#1 (wait)" as "G4 P2.5 (wait)"
RewrittenLine dwell() {
  RewrittenLine line;
  line.copy("G4 ", 1);
  line.replace("P2.5", 4);
  line.copy(" (wait)", 7);
  return line;
}

TEST(RewrittenLine, KnowsTheColumnOfEachCharacter) {
  const RewrittenLine line = dwell();
  EXPECT_EQ(line.text(), "G4 P2.5 (wait)");
  EXPECT_EQ(line.original_column(2), 2);
  for (int column = 4; column <= 7; ++column) EXPECT_EQ(line.original_column(column), 4);
  EXPECT_EQ(line.original_column(8), 7);
  EXPECT_EQ(line.original_column(14), 13);
  EXPECT_EQ(line.original_column(0), 0);  // no column is known
}

TEST(RewrittenLine, ALineAsWrittenKeepsItsColumns) {
  RewrittenLine line = dwell();
  line.set("G1 X1");
  EXPECT_EQ(line.text(), "G1 X1");
  EXPECT_EQ(line.original_column(4), 4);
}

TEST(RewrittenLine, BlanksBeforeAnErasedWordGo) {
  RewrittenLine line;
  line.copy("G1 \t ", 1);
  line.trim_end(" ");
  EXPECT_EQ(line.text(), "G1 \t");
  line.trim_end(" \t");
  line.copy(" F100", 12);
  EXPECT_EQ(line.text(), "G1 F100");
  EXPECT_EQ(line.original_column(4), 13);
}

}  // namespace
}  // namespace servomill::controllers::rewritten_line_test
