// O-words: what LinuxCNC's reference says of them, oddities included, and every refusal.
#include <fmt/format.h>

#include <map>

#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::flow_control_test {
namespace {

// Texts of (PRINT,...) in a program, blank-separated.
std::string said(const std::string& text, const ProgramSetup& setup = usual_setup()) {
  std::string out;
  for (const Move& move : moves_of(text, setup)) {
    if (move.kind == MoveKind::message) out += (out.empty() ? "" : " ") + move.text;
  }
  return out;
}

// Values without the zeros that messages show.
std::string values(const std::string& text, const ProgramSetup& setup = usual_setup()) {
  std::string out = said(text, setup);
  for (std::size_t at; (at = out.find(".000000")) != std::string::npos;) out.erase(at, 7);
  return out;
}

ProgramSetup with_files(std::map<std::string, std::string> files) {
  ProgramSetup setup = usual_setup();
  setup.subroutine_file = [files](const std::string& name) -> std::optional<ProgramText> {
    const auto found = files.find(name);
    if (found == files.end()) return std::nullopt;
    return ProgramText::of_text(found->second, name + ".ngc");
  };
  return setup;
}

TEST(Subroutine, TakesArgumentsAndGivesAValue) {
  EXPECT_EQ(values("o<area> sub\n"
                   "o<area> endsub [#1 * #2]\n"
                   "o<area> call [3] [4]\n"
                   "(print,#<_value> #<_value_returned>)"),
            "12 1");
}

TEST(Subroutine, WithoutAResultGivesZero) {
  EXPECT_EQ(values("o1 sub\no1 return\no1 endsub\no1 call\n(print,#<_value> #<_value_returned>)"),
            "0 0");
}

TEST(Subroutine, HasParametersOneToThirtyOfItsOwn) {
  EXPECT_EQ(values("o1 sub\n(print,#1 #2 #30 #31)\n#1=7 #31=8\no1 endsub\n"
                   "#1=5 #2=6 #30=9 #31=10\no1 call [1]\n(print,#1 #2 #30 #31)"),
            "1 0 0 10 5 6 9 8");
}

TEST(Subroutine, HasNamesOfItsOwnButSharesGlobalOnes) {
  EXPECT_EQ(values("o1 sub\n#<a>=1 #<_g>=2\no1 endsub\n#<a>=3 #<_g>=4\no1 call\n"
                   "(print,#<a> #<_g>)"),
            "3 2");
  EXPECT_EQ(said("o1 sub\n(print,#<a>)\no1 endsub\n#<a>=3\no1 call"), "######");
}

TEST(Subroutine, MayStandBehindItsCallAndBehindTheEnd) {
  EXPECT_EQ(interpret("o1 call\nM2\no1 sub\n(print,here)\no1 endsub\n", "p.nc", {}).front().text,
            "here");
}

TEST(Subroutine, MayCallItself) {
  EXPECT_EQ(values("o<fac> sub\no1 if [#1 le 1]\no<fac> return [1]\no1 endif\n"
                   "o<fac> call [#1 - 1]\no<fac> endsub [#1 * #<_value>]\n"
                   "o<fac> call [5]\n(print,#<_value>)"),
            "120");
}

TEST(Subroutine, NamesKnowNoBlanksAndNoCapitals) {
  EXPECT_EQ(said("o<a bC> sub\n(print,x)\no<abc> endsub\nO < A B C > C A L L"), "x");
  EXPECT_EQ(said("o007 sub\n(print,x)\no7 endsub\n#1=7\no#1 call\no[3+4]call"), "x x");
}

TEST(Subroutine, LabelsWithinAreItsOwn) {
  EXPECT_EQ(said("o1 sub\no5 if [1]\n(print,in)\no5 endif\no1 endsub\n"
                 "o5 if [1]\n(print,out)\no5 endif\no1 call"),
            "out in");
}

TEST(Subroutine, ComesFromAFileOfItsName) {
  const ProgramSetup setup = with_files({{"hole",
                                          "(a pattern)\no<hole> sub\n(print,#1)\n"
                                          "o<hole> endsub\n"},
                                         {"700", "O700\n(print,m98)\nM99\n"}});
  EXPECT_EQ(values("o<hole> call [3]\no<HOLE> call [4]\nM98 P700", setup), "3 4 m98");
}

TEST(Subroutine, FaultsNameTheFileAndTheCalls) {
  const ProgramSetup setup = with_files({{"hole", "o<hole> sub\nG1 X1/0\no<hole> endsub\n"}});
  EXPECT_EQ(fault_of("o1 sub\no<hole> call\no1 endsub\nF100\no1 call", setup),
            "hole.ngc:2:6: error: '/' is only allowed at the start of a block and in [ ]; put "
            "remarks in ( ); "
            "in O<hole>, called in p.nc:2, in O<1>, called in p.nc:5");
}

TEST(Subroutine, RefusesWhatHasNoMeaning) {
  const std::string nine = [] {
    std::string text;
    for (int i = 1; i <= 10; ++i) {
      text += fmt::format("o{} sub\no{} call\no{} endsub\n", i, i + 1, i);
    }
    return text + "o11 sub\no11 endsub\no1 call";
  }();
  const std::map<std::string, std::string> faults = {
      {"o1 endsub", "p.nc:1:1: error: subroutine O<1> has not started"},
      {"o1 sub\no2 sub\no2 endsub\no1 endsub\no1 call",
       "p.nc:2:1: error: a subroutine within the definition of O<1>"},
      {"o1 sub\no1 endsub\no1 sub\no1 endsub",
       "p.nc:3:1: error: O<1> is already defined in line 1"},
      {"o1 call\no1 sub\no1 endsub",
       "p.nc:2:1: error: the program runs into O<1>, which it has already called"},
      {"o1 sub\no1 endsub x\no1 call",
       "p.nc:2:11: error: unexpected 'X' after ENDSUB; an O-word must be in a separate block"},
      {"o1 sub\no1 endsub\nM98 P1",
       "p.nc:1:1: error: O<1> is a subroutine; call it with O<1> CALL; in O<1>, called in p.nc:3"},
      {"o<hole> call\nG0 X1",
       "p.nc:3: error: subroutine O<hole>, called in line 1, not found up to the end of the "
       "program, nor a file hole.ngc (set its folder with --subs)"},
      {"o1.5 sub", "p.nc:1:1: error: O1.5; must be an integer"},
      {"o1 frob", "p.nc:1:4: error: unknown keyword 'FROB' after an O-word"},
      {"o1 cal", "p.nc:1:4: error: unknown keyword 'CAL' after an O-word; did you mean 'CALL'?"},
      {"o<a", "p.nc:1:2: error: label is not closed; '>' is missing"},
      {nine, "p.nc:26:1: error: subroutine calls nested deeper than 9"},
  };
  for (const auto& [text, message] : faults) {
    const std::string found = fault_of(text);
    EXPECT_EQ(found.substr(0, message.size()), message) << text;
  }
}

TEST(LocalSubprogram, IsFoundAtFaultWhereItIsCalled) {
  ProgramSetup setup = usual_setup();
  setup.reader = Reader::haas;
  EXPECT_EQ(fault_of("G0 X1. M97 P30\nM2", setup), "p.nc:1:8: error: M97 P30: block N30 not found");
}

TEST(Subprogram, IsRepeatedByL) {
  EXPECT_EQ(values("#1=1\nM98 P5 L3\n(print,end #1)\nM2\nO5\n(print,#1)\n#1=[#1+1]\nM99"),
            "1 2 3 end 4");
  EXPECT_EQ(said("M98 P5 L0\n(print,end)\nM2\nO5\n(print,no)\nM99"), "end");
}

TEST(Subprogram, EndsWithM99WhichEndsAProgram) {
  const auto moves = interpret("G0 X1\nM99\nG0 X2\n", "p.nc", {});
  EXPECT_EQ(moves.size(), 2U);
  EXPECT_EQ(moves.back().kind, MoveKind::end);
  EXPECT_EQ(fault_of("o1 sub\nM99\no1 endsub\no1 call"),
            "p.nc:2:1: error: a subroutine must end with ENDSUB or RETURN, not with M99; in O<1>, "
            "called in p.nc:4");
}

TEST(Condition, TakesTheFirstBranchThatHolds) {
  const std::string text =
      "o1 if [#1 eq 1]\n(print,one)\no1 elseif [#1 eq 2]\n(print,two)\no1 elseif [#1 eq 2]\n"
      "(print,again)\no1 else\n(print,many)\no1 endif\n";
  EXPECT_EQ(said("#1=1\n" + text), "one");
  EXPECT_EQ(said("#1=2\n" + text), "two");
  EXPECT_EQ(said("#1=3\n" + text), "many");
}

TEST(Condition, MayStandInEachOther) {
  EXPECT_EQ(said("o1 if [1]\no2 if [0]\n(print,a)\no2 else\n(print,b)\no2 endif\no1 else\n"
                 "(print,c)\no1 endif"),
            "b");
}

TEST(Condition, WhatIsSkippedIsNotRead) {
  EXPECT_EQ(said("o1 if [0]\nG1 X[1/0] $\no2 if 5\no3 endif\nM2\no1 endif\n(print,x)"), "x");
  EXPECT_EQ(fault_of("o1 if [0]\n(open\no1 endif"),
            "p.nc:2:1: error: comment is not closed; ')' is missing");
  EXPECT_EQ(fault_of("o1 if [0]\no2 frob\no1 endif"),
            "p.nc:2:4: error: unknown keyword 'FROB' after an O-word");
}

TEST(Loop, WhileTurnsAsLongAsItHolds) {
  EXPECT_EQ(values("#1=0\no1 while [#1 lt 3]\n#1=[#1+1]\n(print,#1)\no1 endwhile"), "1 2 3");
  EXPECT_EQ(values("#1=5\no1 while [#1 lt 3]\n(print,#1)\no1 endwhile"), "");
}

TEST(Loop, DoTurnsOnceAtLeast) {
  EXPECT_EQ(values("#1=5\no1 do\n(print,#1)\n#1=[#1+1]\no1 while [#1 lt 3]"), "5");
  EXPECT_EQ(values("#1=1\no1 do\n(print,#1)\n#1=[#1+1]\no1 while [#1 lt 3]"), "1 2");
}

TEST(Loop, RepeatTurnsARoundedNumberOfTimes) {
  EXPECT_EQ(said("o1 repeat [1.6]\n(print,a)\no1 endrepeat"), "a a");
  EXPECT_EQ(said("o1 repeat [-1]\n(print,a)\no1 endrepeat"), "");
  EXPECT_EQ(said("o1 repeat [2]\no2 repeat [2]\n(print,a)\no2 endrepeat\no1 endrepeat"), "a a a a");
}

TEST(Loop, BreakLeavesAndContinueTurns) {
  EXPECT_EQ(values("#1=0\no1 while [1]\n#1=[#1+1]\no2 if [#1 eq 2]\no1 continue\no2 endif\n"
                   "o3 if [#1 eq 4]\no1 break\no3 endif\n(print,#1)\no1 endwhile"),
            "1 3");
}

// As rs274 2.9 does it; see FlowState.
TEST(Loop, ABreakOutOfWhileCutsTheNextDoShort) {
  EXPECT_EQ(values("o1 while [1]\no1 break\no1 endwhile\n#1=0\n"
                   "o3 do\n#1=[#1+1]\n(print,#1)\no3 while [#1 lt 3]"),
            "1");
}

TEST(Loop, FaultsSayWhatTheLabelIs) {
  const std::map<std::string, std::string> faults = {
      {"o1 endwhile", "p.nc:1:1: error: O1 has no matching start before this line"},
      {"o1 if [1]\no1 endwhile", "p.nc:2:1: error: O1 is not WHILE but if, in line 1"},
      {"o1 repeat [2]\no1 break\no1 endrepeat",
       "p.nc:2:1: error: O1 is neither a WHILE nor a DO but repeat, in line 1"},
      {"o1 while [0]\no1 endwhile\no1 else",
       "p.nc:3:1: error: O1 is not an IF but while, in line 1"},
      {"o1 if [1]\no1 endif\no1 if [1]\no1 endif",
       "p.nc:3:1: error: label already used in line 1 for if"},
      {"o1 while", "p.nc:1:9: error: expected '[' after WHILE, found the end of the line"},
      {"o1 while [1", "p.nc:1:10: error: '[' is not closed; ']' is missing"},
      {"o1 if [0]\nG0 X1", "p.nc:3: error: the program ends while skipping to O1 from line 1"},
  };
  for (const auto& [text, message] : faults) EXPECT_EQ(fault_of(text), message) << text;
}

TEST(ExecutedBlocks, AreTheLinesInTheOrderOfTheirRun) {
  Interpreter interpreter(
      "G21 (mm)\n\no1 repeat [2]\n#5=[#5+1] G0 X[#5]\no1 endrepeat\no2 if [0]\nG0 X9\n"
      "o2 endif\nM2\n",
      "p.nc", {});
  std::string lines;
  std::vector<double> ends, assigned;
  while (const auto block = interpreter.next_block()) {
    lines += fmt::format("{}{}{}{} ", block->line, block->block == nullptr ? "-" : "",
                         block->is_repeated ? "r" : "", block->request == nullptr ? "" : "w");
    for (const Move& move : block->moves) {
      if (is_motion(move.kind)) ends.push_back(move.end[0] / mm);
    }
    for (const auto& [number, value] : block->assigned) assigned.push_back(value);
  }
  EXPECT_EQ(lines, "1w 2- 3 4w 5 3r 4rw 5r 3r 4-r 5r 6 7- 8 9w ");
  EXPECT_EQ(ends, (std::vector<double>{0, 1}));
  EXPECT_EQ(assigned, (std::vector<double>{1, 2}));
}

TEST(Loop, WithoutEndIsStopped) {
  ProgramSetup setup = usual_setup();
  setup.most_jumps = 1000;
  EXPECT_EQ(fault_of("o1 while [1]\no1 endwhile", setup),
            "p.nc:2:1: error: 1001 loop iterations and subroutine calls, 2000 lines; the program "
            "appears to loop endlessly");
  std::string body;
  for (int i = 0; i < 98; ++i) body += "G1 X1 F1\n";
  EXPECT_EQ(fault_of("o1 while [1]\n" + body + "o1 endwhile", setup),
            "p.nc:100:1: error: 102 loop iterations and subroutine calls, 10100 lines; the program "
            "appears to loop endlessly");
}

}  // namespace
}  // namespace servomill::controllers::flow_control_test
