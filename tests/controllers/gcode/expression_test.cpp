// Values of expressions, read through a parameter that becomes a message with six decimals.
#include <fmt/format.h>

#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::expression_test {
namespace {

std::string value_of(const std::string& expression) {
  return last_move(fmt::format("#1={}\n(DEBUG,#1)", expression)).text;
}

TEST(Expression, OperatorsBindInFiveLevelsFromTheLeft) {
  EXPECT_EQ(value_of("[2 ** 3 ** 2]"), "64.000000");
  EXPECT_EQ(value_of("[2 * 3 ** 2]"), "18.000000");
  EXPECT_EQ(value_of("[12 / 2 * 3 MOD 4]"), "2.000000");
  EXPECT_EQ(value_of("[10 - 2 - 3]"), "5.000000");
  EXPECT_EQ(value_of("[1 + 2 LT 4 AND 5 - 5 OR 1]"), "1.000000");
  EXPECT_EQ(value_of("[1 OR 0 AND 0]"), "0.000000");
  EXPECT_EQ(value_of("[1 XOR 1 OR 1]"), "1.000000");
}

TEST(Expression, MinusBelongsToTheValueThatFollows) {
  EXPECT_EQ(value_of("[-2 ** 2]"), "4.000000");
  EXPECT_EQ(value_of("[2--2]"), "4.000000");
  EXPECT_EQ(value_of("-[2]"), "-2.000000");
  EXPECT_EQ(value_of("--2"), "2.000000");
  EXPECT_EQ(value_of("-SIN[30]"), "-0.500000");
}

TEST(Expression, ModIsNeverNegative) {
  EXPECT_EQ(value_of("[-7 MOD 3]"), "2.000000");
  EXPECT_EQ(value_of("[7 MOD -3]"), "1.000000");
}

TEST(Expression, EqualityHasATolerance) {
  EXPECT_EQ(value_of("[1 EQ 1.00009]"), "1.000000");
  EXPECT_EQ(value_of("[1 EQ 1.00011]"), "0.000000");
  EXPECT_EQ(value_of("[1 NE 1.00009]"), "0.000000");
  EXPECT_EQ(value_of("[1 GE 1.00005]"), "0.000000");
  EXPECT_EQ(value_of("[1 LT 1.00005]"), "1.000000");
}

TEST(Expression, FunctionsTakeAndGiveDegrees) {
  EXPECT_EQ(value_of("SIN[30]"), "0.500000");
  EXPECT_EQ(value_of("COS[60]"), "0.500000");
  EXPECT_EQ(value_of("TAN[45]"), "1.000000");
  EXPECT_EQ(value_of("ASIN[0.5]"), "30.000000");
  EXPECT_EQ(value_of("ACOS[0.5]"), "60.000000");
  EXPECT_EQ(value_of("[ATAN[1]/[-1] * 2]"), "270.000000");
  EXPECT_EQ(value_of("ABS[-3]"), "3.000000");
  EXPECT_EQ(value_of("EXP[1]"), "2.718282");
  EXPECT_EQ(value_of("LN[EXP[2]]"), "2.000000");
  EXPECT_EQ(value_of("SQRT[2]"), "1.414214");
}

TEST(Expression, RoundGoesAwayFromZeroAndFixDown) {
  EXPECT_EQ(value_of("ROUND[2.5]"), "3.000000");
  EXPECT_EQ(value_of("ROUND[-2.5]"), "-3.000000");
  EXPECT_EQ(value_of("FIX[-2.5]"), "-3.000000");
  EXPECT_EQ(value_of("FUP[-2.5]"), "-2.000000");
}

TEST(Expression, BlanksAndCaseDoNotMatter) {
  EXPECT_EQ(value_of("[ 1 0 + s i n [ 3 0 ] ]"), "10.500000");
}

TEST(Parameter, AssignmentsTakeEffectAfterTheirBlock) {
  const auto moves = moves_of("#1=1\nG0 X#1 #1=3 Y#1\nX#1");
  expect_axes(moves[0].end, axes(1, 1, 0));
  expect_axes(moves[1].end, axes(3, 1, 0));
}

TEST(Parameter, NamesIgnoreBlanksAndCase) {
  EXPECT_EQ(
      last_move("#<My Value>=2\n#<_global>=[#<myvalue>+1]\n(DEBUG,#<MYVALUE> #<_global>)").text,
      "2.000000 3.000000");
}

TEST(Parameter, NumbersMayBeComputed) {
  EXPECT_EQ(last_move("#[1+1]=7\n#1=2\n#3=##1\n(DEBUG,#3)").text, "7.000000");
}

TEST(Parameter, ExistsAsksWithoutReading) {
  EXPECT_EQ(value_of("EXISTS[#<nowhere>]"), "0.000000");
  EXPECT_EQ(last_move("#<here>=0\n#1=EXISTS[#<here>]\n(DEBUG,#1)").text, "1.000000");
}

TEST(Parameter, SetupSetsNumbersAndNames) {
  ProgramSetup setup;
  setup.parameters = {{"#101", 12.5}, {"#<feed rate>", 600.0}};
  const Move move = last_move("G1 X#101 F#<feedrate>", setup);
  expect_axes(move.end, axes(12.5, 0, 0));
  EXPECT_DOUBLE_EQ(move.feed, 0.010);
}

TEST(Parameter, MachineTellsItsPositionInProgramUnits) {
  EXPECT_EQ(last_move("G0 X25.4 A10\nG20\n(DEBUG,#5420 #5423 #<_x> #<_imperial>)").text,
            "1.000000 10.000000 1.000000 1.000000");
}

TEST(Message, OnlyDebugAndPrintSubstitute) {
  const auto moves = moves_of("#1=2\n(MSG, a #1)\n(debug, #1 #<no> #[1] ##1)\n(print,#1)\n(plain)");
  ASSERT_EQ(moves.size(), 3u);
  EXPECT_EQ(moves[0].text, "a #1");
  EXPECT_EQ(moves[1].text, "2.000000 ###### #[1] #2.000000");
  EXPECT_EQ(moves[2].text, "2.000000");
}

}  // namespace
}  // namespace servomill::controllers::expression_test
