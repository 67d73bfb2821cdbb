// Custom macro B: what is refused, with its place, and what a simulation knows of the control. The
// moves of programs are in rule_examples_macros.h.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "controllers/gcode/called_subroutines.h"
#include "controllers/gcode/interpreter.h"
#include "rule_examples.h"

namespace servomill::controllers::macro_test {

// moves, or the refusal
std::string run(const std::string& program, Reader reader = Reader::fanuc,
                const Given& given = {}) {
  return read(program, reader, given).moves;
}

std::string refusal(const std::string& program, Reader reader = Reader::fanuc) {
  const std::string out = run(program, reader);
  const std::string begin = "p.nc:";
  return out.starts_with(begin) ? out.substr(begin.size()) : "no refusal: " + out;
}

TEST(Macro, NothingIsReadInSilenceThatIsNoMacroB) {
  EXPECT_EQ(refusal("#1=2**3\nM2\n"), "1:6: error: expected a value");
  EXPECT_EQ(
      refusal("#1=5. X1.\nM2\n"),
      "1:7: error: unexpected 'X' after a macro statement, which must be in a separate block");
  EXPECT_EQ(refusal("G0 X#1+5.\nM2\n"),
            "1:7: error: unexpected '+': an expression of several terms must be in brackets, as in "
            "X[#1+5]");
  EXPECT_EQ(refusal("##1=5.\nM2\n"), "1:2: error: ## is not supported; write #[#1]");
  EXPECT_EQ(refusal("#1=SINE[5.]\nM2\n"),
            "1:4: error: unknown function 'SINE'; did you mean 'SIN'?");
  EXPECT_EQ(refusal("#1=[5.\nM2\n"), "1:4: error: '[' is not closed; ']' is missing");
  EXPECT_EQ(refusal("#0=1\nM2\n"), "1:1: error: #0 is always vacant and cannot be set");
  EXPECT_EQ(refusal("#50=1\nM2\n"), "1:1: error: variable #50 does not exist");
  EXPECT_EQ(refusal("#1=1/#0\nM2\n"), "1:5: error: division by zero");
  EXPECT_EQ(refusal("N10 IF[#1GT2]X5.\nM2\n"), "1:14: error: expected GOTO or THEN after IF[...]");
  EXPECT_EQ(refusal("IF[#1EQ#0]THEN X5.\nM2\n"),
            "1:16: error: expected a macro statement after THEN");
  EXPECT_EQ(refusal("#1=ADP[5]\nM2\n"),
            "1:4: error: ADP adds a decimal point by the increments of the control, which are "
            "unknown; write the value with its decimal point");
}

TEST(Macro, VacancyIsNotGuessed) {
  const std::string doubt =
      "error: a vacant variable after a sign or alone in brackets: it is undocumented whether it "
      "is 0 or remains vacant; remove the sign or brackets, or set it";
  EXPECT_EQ(refusal("G0 X[#1]\nM2\n"), "1:5: " + doubt);
  EXPECT_EQ(refusal("#2=-#1\nM2\n"), "1:5: " + doubt);
  EXPECT_EQ(run("#2=[#1]*2.\nG0 X#2 Y1.\nM2\n"), "R 0 1 0");
}

TEST(Macro, TheOrderOfLogicIsWrittenInBrackets) {
  const std::string order =
      "error: AND, OR or XOR combined with other operators: the precedence differs between "
      "controls; put brackets around each part";
  EXPECT_EQ(refusal("IF[#1AND#2EQ2]GOTO9\nN9 M2\n", Reader::haas), "1:4: " + order);
  EXPECT_EQ(refusal("IF[#1EQ1AND#2EQ2]GOTO9\nN9 M2\n", Reader::haas),
            "1:14: error: more than one comparison; put brackets around each");
  EXPECT_EQ(refusal("#1=1+2AND3\nM2\n", Reader::haas), "1:4: " + order);
  // AND binds as * does: 1 + (2 AND 3); Fanuc B-63944EN, priority of operations, from memory
  EXPECT_EQ(run("#1=1+2AND3\nG0 X#1\nM2\n"), "R 3 0 0");
  EXPECT_EQ(run("IF[[1EQ1]AND[2GT1]]GOTO9\nG0 X1.\nN9 G0 Y1.\nM2\n", Reader::any), "R 0 1 0");
}

TEST(Macro, AModalCallIsFaultedAtTheBlockThatCalls) {
  EXPECT_EQ(refusal("#1=0\nN100 (MILL) G66 P9010 Z-1.\nG0 X3.\nG67\nM2\n"),
            "3:1: error: program O9010 not found in this file, nor a file 9010.ngc");
}

TEST(Macro, JumpsAndLoopsHaveTheirRules) {
  EXPECT_EQ(refusal("GOTO 7\nM2\nO2\nN7 M99\n"), "1:6: error: block N7 not found in this program");
  EXPECT_EQ(refusal("M98 P2 (GOTO)\n#1=1\nM2\nO2\nG0 X1. M99 P7\n"),
            "5:8: error: block N7 not found in the calling program")
      << "where the jump is written, not where it goes to";
  EXPECT_EQ(refusal("GOTO 7\nWHILE[#1LT2]DO1\nN7 G0 X1.\nEND1\nM2\n"),
            "1:6: error: N7 is inside the loop DO1 of line 2: jumps into a loop are not allowed");
  EXPECT_EQ(refusal("WHILE[#1LT2]DO4\nEND4\nM2\n"),
            "1:1: error: the number of DO must be 1, 2 or 3");
  EXPECT_EQ(refusal("WHILE[#1LT2]DO1\nM2\n"), "1:1: error: DO1 has no END1");
  EXPECT_EQ(refusal("#1=0\nEND1\nM2\n"), "2:1: error: END without a matching DO before it");
  EXPECT_EQ(refusal("WHILE[#1LT2]DO1\nWHILE[#1LT2]DO1\nEND1\nEND1\nM2\n"),
            "2:1: error: DO1 within the loop DO1 of line 1");
}

TEST(Macro, AnEndlessProgramIsStopped) {
  ProgramSetup setup = setup_of({}, Reader::fanuc);
  setup.most_jumps = 20;
  try {
    interpret("N1 G0 X1.\nGOTO 1\n", "p.nc", setup);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "p.nc:2:1: error: 21 jumps, loop iterations and calls, 40 lines; the program "
                 "appears to loop endlessly");
  }
}

TEST(Macro, CallsAreChecked) {
  EXPECT_EQ(refusal("#1=1.\nG65 A1.\nM2\n"), "2:1: error: G65 requires a P word (program number)");
  EXPECT_EQ(refusal("G65 P77 A1.\nM2\n"),
            "1:5: error: program O77 not found in this file, nor a file 77.ngc");
  EXPECT_EQ(refusal("#1=1.\nG90 G65 P1 A1.\nM2\nO1\nM99\n"),
            "2:1: error: G65 must precede its arguments; program G in a separate block");
  EXPECT_EQ(refusal("G65 P1\nM2\nO1\nG65 P1\nM99\n"),
            "4:5: error: macro calls nested deeper than 4; in O1, called in p.nc:4, in O1, "
            "called in p.nc:4, in O1, called in p.nc:4, in O1, called in p.nc:1");
  EXPECT_EQ(refusal("G65 P1\nM2\nO1\nG0 X1.\n"),
            "4: error: a called program must end with M99; in O1, called in p.nc:1");
  EXPECT_EQ(refusal("G65 P1 A1. L2\nM2\nO1\n#1=#1+1.\nM99\n"),
            "5: error: the program changes its local variables and L calls it again: controls "
            "differ in whether the values are kept; use a WHILE loop; in O1, called in p.nc:1");
  EXPECT_EQ(refusal("#1=1.\nG0 X1.\nO2\nM30\n"), "no refusal: R 1 0 0");
}

// N50 [#100 LT 10] M99 P10: Haas 96-8000, June 1999, p. 376.
TEST(Macro, HaasReturnsAndJumpsOnACondition) {
  const std::string program =
      "G65 P1 A3.\nG0 Y1.\nM2\nO1\nN10 #1=#1-1\nG0 X#1\nN50 [#1 GT 1] M99 P10\n[#1 EQ 1] M99\n"
      "X9.\nM99\n";
  EXPECT_EQ(run(program, Reader::haas), "R 2 0 0 | R 1 0 0 | R 1 1 0");
  EXPECT_EQ(refusal(program),
            "7:5: error: a condition before M99 is Haas syntax; use IF[...]GOTO; in O1, called in "
            "p.nc:1");
  EXPECT_EQ(refusal("[1 EQ 1] X5.\nM2\n", Reader::haas),
            "1:1: error: expected M99, or M99 P with a block number, after a condition");
}

TEST(Macro, AProgramInAFileOfItsOwnIsCalled) {
  ProgramSetup setup = setup_of({}, Reader::any);
  setup.subroutine_file = [](const std::string& name) -> std::optional<ProgramText> {
    if (name != "9010") return std::nullopt;
    return ProgramText::of_text("%\nO9010\nG0 X#1\nIF[#1GT2]GOTO 1\nM99\nN1 Y[#2/0]\nM99\n%\n",
                                "9010.ngc");
  };
  EXPECT_EQ(interpret("G65 P9010 A2.\nM2\n", "p.nc", setup).front().end_machine[0], 2.0 * mm);
  try {
    interpret("G65 P9010 A3.\nM2\n", "p.nc", setup);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "9010.ngc:6:8: error: division by zero; in O9010, called in p.nc:1");
  }
}

TEST(Macro, BracketsAreOnlySoDeep) {
  const std::string open(50, '['), close(50, ']');
  EXPECT_EQ(refusal("#1=" + open + "1" + close + "\nM2\n"),
            "1:44: error: brackets and signs are nested too deeply");
}

// A fault of the block names the column in the line as written, and the calls.
TEST(Macro, FaultsOfBlocksAreAtTheirWords) {
  EXPECT_EQ(refusal("G65 P1 A12.345\nM2\nO1\nG0 X#1 Y[#1*2.] G777\nM99\n"),
            "4:17: error: unknown G code G777; in O1, called in p.nc:1");
}

TEST(Macro, AnAlarmOfTheProgramStopsIt) {
  EXPECT_EQ(refusal("IF[#1EQ#0]GOTO9\nM2\nN9 #3000=12(NO DEPTH)\n"),
            "3:4: error: the program raises an alarm (#3000=12): NO DEPTH");
  EXPECT_EQ(run("G0 X1.\n#3006=1(TURN THE PART)\nX2.\nM2\n"), "R 1 0 0 | P0 | R 2 0 0");
}

TEST(Macro, ValuesThatASimulationCannotKnowAreRefusedByName) {
  EXPECT_EQ(refusal("#1=#500\nM2\n"),
            "1:4: error: #500 keeps its value from earlier programs and is not set in this "
            "program; set it with --parameter '#500=...'");
  EXPECT_EQ(refusal("IF[#1004EQ1]GOTO9\nN9 M2\n"),
            "1:4: error: #1004 is an input of the machine: it is unknown in a simulation; or set "
            "it with --parameter '#1004=...'");
  EXPECT_EQ(refusal("#1=#3011\nM2\n"),
            "1:4: error: #3011 is date and time: it is unknown in a simulation; or set it with "
            "--parameter '#3011=...'");
  EXPECT_EQ(refusal("#1=#5063\nM2\n"),
            "1:4: error: #5063 is the position at the skip signal: it is unknown in a simulation; "
            "or set it with --parameter '#5063=...'");
  EXPECT_EQ(refusal("#2001=5.\nM2\n"),
            "1:1: error: #2001 is a tool offset and cannot be set here: enter it in the tool table "
            "(--tools), and remove the line");
  ProgramSetup setup = setup_of({}, Reader::fanuc);
  setup.parameters["#500"] = 12.5;
  const auto moves = interpret("G0 X#500\nM2\n", "p.nc", setup);
  EXPECT_EQ(moves[0].end_machine[0], 12.5 * mm);
}

TEST(Macro, LengthsOfToolsAreThoseOfTheToolTable) {
  const auto first_x = [](Reader reader, const std::string& program) {
    ProgramSetup setup = setup_of({}, reader);
    setup.tools = ToolTable::parse("T3 P3 Z+50.8 D6\n", "tool.tbl");
    return interpret(program, "p.nc", setup).at(0).end_machine[0];
  };
  EXPECT_NEAR(first_x(Reader::haas, "#1=#2003\nG0 X#1\nM2\n"), 50.8 * mm, 1e-12);
  EXPECT_NEAR(first_x(Reader::fanuc, "G20\n#1=#11003\nG0 X#1\nM2\n"), 2.0 * inch, 1e-12);
  const auto fault = [&](Reader reader, const std::string& program) {
    try {
      return fmt::format("X{}", first_x(reader, program));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(fault(Reader::haas, "#1=#2004\nG0 X#1\nM2\n"),
            "p.nc:1:4: error: #2004 is a tool offset: the length of tool 4 is unknown; pass a tool "
            "table with --tools; or set it with --parameter '#2004=...'");
  // what #2003 is depends on the tool memory (A, B or C), and wear stands in no table
  EXPECT_EQ(fault(Reader::fanuc, "#1=#2003\nG0 X#1\nM2\n"),
            "p.nc:1:4: error: #2003 is a tool offset: it is unknown in a simulation; or set it "
            "with --parameter '#2003=...'");
  EXPECT_EQ(fault(Reader::haas, "#1=#2203\nG0 X#1\nM2\n"),
            "p.nc:1:4: error: #2203 is a tool offset: it is unknown in a simulation; or set it "
            "with --parameter '#2203=...'");
}

TEST(Macro, ArcTangentOfTwoNumbersHasTwoForms) {
  EXPECT_EQ(run("#1=ATAN[1.,-1.]+ATAN[1.]/[-1.]\nG0 X#1\nM2\n"), "R 270 0 0");
  EXPECT_EQ(refusal("#1=ATAN[1.,-1.\nM2\n"), "1:8: error: '[' is not closed; ']' is missing");
}

// work offset X100 Y200 Z300
TEST(Macro, PositionsModesAndOffsetsAreThoseOfTheBlockBefore) {
  const Given offsets = {.has_offsets = true};
  EXPECT_EQ(run("G0 X1. Y2. Z3.\n#1=#5001+#5042\n#2=#5022\n#3=#5223\nX#1 Y#2 Z#3\nM2\n",
                Reader::fanuc, offsets),
            "R 101 202 303 | R 103 402 600");
  const std::string unknown =
      "the work offset is unknown; set it with --work-offset (other than 0) or --parameter-file";
  EXPECT_EQ(refusal("G0 X1.\n#1=#5221\nM2\n"), "2:4: error: #5221 is a work offset: " + unknown +
                                                   "; or set it with --parameter '#5221=...'");
  EXPECT_EQ(refusal("G0 X1.\n#1=#5021\nM2\n"),
            "2:4: error: #5021 is the machine position: " + unknown +
                "; or set it with --parameter '#5021=...'");
  EXPECT_EQ(run("G10 L2 P2 X5. Y0. Z0.\nG0 X#5241\nM2\n"), "R 5 0 0");
  EXPECT_EQ(run("G91 G20 G1 X1. F10.\n#1=#4001\n#2=#4003\n#3=#4006\nG21 G0 G90\nG#1 X#2 Y#3 "
                "F#4109\nM2\n"),
            "F 25.4 0 0 f254 | F 91 20 0");
  EXPECT_EQ(refusal("#1=#4014\nM2\n", Reader::haas),
            "1:4: error: #4014 is an active mode: the work offset is #4014 (Fanuc) or #4012 "
            "(Haas); choose with --reader fanuc or haas; or set it with --parameter '#4014=...'");
  EXPECT_EQ(run("G55\n#1=#4014\nG54\nG0 X#1\nM2\n"), "R 55 0 0");
}

TEST(Macro, AComparisonNearerThanControlsCalculateIsWarnedOf) {
  const Reading found = read("#1=.1+.2\nIF[#1EQ.3]GOTO9\nG21 G0 X1.\nN9 M2\n", Reader::fanuc, {});
  EXPECT_EQ(found.moves, "R 1 0 0");
  ASSERT_EQ(found.warnings.size(), 2u);
  EXPECT_EQ(
      to_string(found.warnings[1]),
      "p.nc:2:6: error: the compared values, 0.3 and a value 6e-17 away, differ by less than the "
      "precision of controls: another control may branch differently; compare with a tolerance");
}

// Readings that Fanuc and Haas share count, since no other control reads the program.
TEST(Macro, WordsAreReadAsTheControlsDoThatHaveMacros) {
  EXPECT_EQ(run("G4 P1500\nIF[1EQ1]GOTO9\nN9 M2\n", Reader::any), "W 1.5");
}

// Fanuc B-64124EN/01, subprogram, from memory; Haas has M99 P too, from memory.
TEST(Macro, AReturnToABlockNeedsNoVariables) {
  const std::string program = "M98 P100\nG0 X9.\nN5 G0 Y1.\nM2\nO100\nG0 X1.\nM99 P5\n";
  EXPECT_EQ(run(program), "R 1 0 0 | R 1 1 0");
  EXPECT_EQ(run("G0 X1.\n/M99 P9\nX2.\nN9 Y1.\nM2\n", Reader::any), "R 1 0 0 | R 1 1 0");
}

TEST(Macro, OtherReadersDoNotHaveIt) {
  for (const Reader reader : {Reader::linuxcnc, Reader::mach, Reader::grbl}) {
    EXPECT_EQ(
        refusal("#1=1\nIF[#1EQ1]GOTO9\nN9 M2\n", reader),
        "2:2: error: 'IF' is a Fanuc macro statement; only LinuxCNC O-words are supported here");
  }
  // O-words and parameters of LinuxCNC stay what they are
  EXPECT_EQ(run("#1=2\no1 if [#1 gt 1]\nG0 X#1 Y#2\no1 endif\nM2\n", Reader::any), "R 2 0 0");
}

// As conditions 1 AND 2 is 1, of their bits 0.
TEST(Macro, LogicWhoseReadingsDifferIsRefusedWithBoth) {
  const auto any = [](const std::string& program) { return run(program, Reader::any); };
  EXPECT_EQ(any("G0 X[1 AND 2]\nM2\n"),
            "p.nc:1:8: error: 1 AND 2: 1 as logical operation (LinuxCNC), or 0 as bitwise "
            "operation (Fanuc, Haas); choose with --reader linuxcnc, fanuc or haas");
  EXPECT_EQ(any("G[20 OR ABS[20]] X1.\nM2\n"),
            "p.nc:1:6: error: 20 OR 20: 1 as logical operation (LinuxCNC), or 20 as bitwise "
            "operation (Fanuc, Haas); choose with --reader linuxcnc, fanuc or haas");
  EXPECT_EQ(any("G0 X[0.5 XOR 1]\nM2\n"),
            "p.nc:1:10: error: 0.5 XOR 1: 0 as logical operation (LinuxCNC), or undefined as "
            "bitwise operation, which requires integers >= 0 (Fanuc, Haas); choose with --reader "
            "linuxcnc, fanuc or haas");
  EXPECT_EQ(any("G0 X[5 AND 0] Y[1 OR 0] Z[1 XOR 1]\nM2\n"), "R 0 1 0");
  EXPECT_EQ(run("G0 X[1 AND 2]\nM2\n", Reader::linuxcnc), "R 1 0 0");
  EXPECT_EQ(run("#1=12 AND 10\nG0 X#1\nM2\n"), "R 8 0 0");
  // names are LinuxCNC's
  EXPECT_EQ(any("#<a> = 2\nG0 X[1 AND #<a>]\nM2\n"), "R 1 0 0");
}

TEST(Macro, WhatStandsBehindThenIsCheckedWhereItDoesNotRun) {
  EXPECT_EQ(refusal("IF[1EQ2]THEN #1=[5.\nM2\n"), "1:17: error: '[' is not closed; ']' is missing");
  EXPECT_EQ(refusal("IF[1EQ2]THEN #1=5.]\nM2\n"), "1:19: error: ']' without a '[' before it");
  EXPECT_EQ(refusal("IF[1EQ2]THEN #1=5.+\nM2\n"), "1:19: error: expected a value after it");
  EXPECT_EQ(refusal("IF[1EQ2]THEN GOTO\nM2\n"),
            "1:14: error: expected a macro statement after THEN");
  EXPECT_EQ(run("IF[1EQ2]THEN #1=1./0\nG0 X1.\nM2\n"), "R 1 0 0");
}

// Which of G0 and G1 is in force at power-on is parameter 3402#0.
TEST(Macro, ModesBeforeTheFirstMotion) {
  EXPECT_EQ(refusal("#1=#4001\nG0 X1.\nM2\n"),
            "1:4: error: #4001 is an active mode: no G0, G1, G2 or G3 precedes it: the active one "
            "depends on the control (Fanuc, parameter 3402#0); program one; or set it with "
            "--parameter '#4001=...'");
  EXPECT_EQ(run("G1 X1. F100.\n#1=#4001\n#2=#4009\n#3=#4008\nG0 X#1 Y#2 Z#3\nM2\n"),
            "F 1 0 0 f100 | R 1 80 49");
}

// Nothing in them says for which control they are: LinuxCNC's reading, with a warning.
TEST(Macro, VariablesThatControlsReadDifferentlyAreWarnedOf) {
  const Reading found =
      read("#1=FIX[-1.5]\nG0 X#1 Y#2 G21\nX[#1+#2]\n#3=[1 AND 1]\nM2\n", Reader::any, {});
  EXPECT_EQ(found.moves, "R -2 0 0");
  ASSERT_EQ(found.warnings.size(), 2u);
  EXPECT_EQ(to_string(found.warnings[0]),
            "p.nc:1:4: error: FIX, FUP, ATAN and MOD follow LinuxCNC; Fanuc and Haas differ for "
            "negative numbers and in the range of angles; choose with --reader linuxcnc, fanuc or "
            "haas");
  EXPECT_EQ(to_string(found.warnings[1]),
            "p.nc:2:9: error: #2 is read before it is set: 0 (LinuxCNC), or vacant, so that its "
            "word is ignored (Fanuc, Haas); choose with --reader linuxcnc, fanuc or haas");
  // O-words are LinuxCNC's
  const Reading flow = read("o1 if [1]\nG0 X#2 Y[FIX[-1]] G21\no1 endif\nM2\n", Reader::any, {});
  EXPECT_TRUE(flow.warnings.empty());
}

TEST(Macro, ProgramsThatItCallsAreFound) {
  const auto names = called_subroutines(
      ProgramText::of_text("G65 P9010 A1.\nIF[#1EQ1]GOTO9\nM98 P51002\nN9 G66 P20\nM2\n", "p.nc"));
  EXPECT_EQ(names, (std::set<std::string>{"1002", "20", "51002", "9010"}));
}

TEST(Macro, ALineWithASlashIsLeftOutWithItsStatement) {
  const std::string program = "#1=1.\n/#1=2.\n/2 GOTO 9\nG0 X#1\nN9 M2\n";
  EXPECT_EQ(run(program, Reader::fanuc, {.skips_blocks = true}), "R 1 0 0");
  EXPECT_EQ(run(program), "");
}

}  // namespace servomill::controllers::macro_test
