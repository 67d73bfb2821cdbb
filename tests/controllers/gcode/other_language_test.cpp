// Programs and lines that are no G-code are refused by the name of their language.
#include "controllers/gcode/other_language.h"

#include <gtest/gtest.h>

#include <string>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/input_error.h"
#include "tests/controllers/gcode/tolerant_reading.h"

namespace servomill::controllers::other_language_test {
namespace {

using program_reader_test::besides_unit;
using program_reader_test::refusal;

// A word may mean something else there (G4 F, G64, D): none is read by the rules of another
// control unless the user names it.
TEST(OtherLanguage, CornersWithAVariableAreRefusedByName) {
  EXPECT_EQ(other_language("G1 X10. ,R#1", 9),
            "',R' with a variable (Fanuc, Haas) is not supported; write the number");
  EXPECT_EQ(other_language("X10. ,C [#1/2]", 6),
            "',C' with a variable (Fanuc, Haas) is not supported; write the number");
}

TEST(OtherLanguage, SubroutinesOfFadalAreRefusedByName) {
  EXPECT_EQ(refusal("N1 O2 (HOLES)\nN2 L100\nN3 X-24. Y6.\nN4 M17\n"),
            "p.nc:2:4: error: L100 starts a Fadal subroutine (format 1), which is not supported; "
            "output the program in format 2");
}

std::string fault_in(const std::string& file, const std::string& text, Reader reader) {
  ProgramSetup setup;
  setup.reader = reader;
  try {
    interpret(text, file, setup);
  } catch (const InputError& error) {
    return to_string(error.faults().front());
  }
  return {};
}

// I and J are positions there, so the lines must not be taken for G-code.
TEST(OtherLanguage, DinIsoOfHeidenhainIsRefusedByItsFirstLine) {
  const std::string refusal =
      "p.nc:1:1: error: this is a Heidenhain DIN/ISO program (G70 or G71 after its name), whose I, "
      "J and K are absolute; only conversational is supported: convert it on the control or its "
      "programming station, or post-process for Fanuc or LinuxCNC";
  const std::string rest = "N10 G90\nN20 I+10 J+0\nN30 G2 X+10 Y+10\nN40 M30\n";
  for (const std::string first : {"% 123 G71", "%PART G70 *", "%PART G71*\r"}) {
    for (const Reader reader : {Reader::any, Reader::fanuc}) {
      EXPECT_EQ(fault_in("p.nc", first + "\n" + rest, reader), refusal) << first;
    }
  }
  EXPECT_EQ(fault_in("p.nc", "%\nG0 X1.\nM2\n%\n", Reader::any), "");
  EXPECT_EQ(fault_in("p.nc", "%PARTG71\nG0 X1.\nM2\n%\n", Reader::any), "");
}

TEST(OtherLanguage, BlocksBehindASemicolonAreNotLostInSilence) {
  EXPECT_EQ(column_of_second_block("G0 X1.; Y-2. F.5;"), 9);
  for (const std::string line : {"G0 X1.;", ";G0 X1.", "G0 X1. ; to X1", "G0 (a; b) X1.",
                                 "(a) ; X1", "M8 ; 2 mm", "G0 X1 ; X-"}) {
    EXPECT_EQ(column_of_second_block(line), 0) << line;
  }
  const std::string program = "G0 X1.; Y2.\nX3.; Y4.\nM2\n";
  const std::string said =
      "p.nc:1:9: error: words after ';': a comment (LinuxCNC, grbl, Mach), or another block "
      "(Fanuc, Haas, where ';' ends a block); write each block on a separate line, or comments in "
      "( )";
  EXPECT_EQ(fault_in("p.nc", program, Reader::haas), said);
  ProgramSetup setup;
  setup.reader = Reader::any;
  Interpreter interpreter(program, "p.nc", setup);
  interpreter.rest();
  ASSERT_EQ(besides_unit(interpreter.warnings()).size(), 1u);
  EXPECT_EQ(to_string(besides_unit(interpreter.warnings()).front()), said);
}

TEST(OtherLanguage, LinesThatWereNotFilledInAreNamed) {
  EXPECT_EQ(other_language("#region tools", 2),
            "'#region' is a fold mark of an editor; remove the line");
  EXPECT_EQ(other_language("O ENTER THE NUMBER", 3),
            "O requires a program number; write one (O1000), or remove the line");
  EXPECT_EQ(other_language("O 100", 3), "");
  EXPECT_EQ(other_language("O  ", 3), "") << "nothing behind O";
}

TEST(OtherLanguage, LinesAreNamedByTheWordsThatGiveThemAway) {
  EXPECT_EQ(other_language("12 CYCL DEF 200 DRILLING", 1),
            "'CYCL DEF' is Heidenhain conversational; use --reader heidenhain");
  EXPECT_EQ(other_language("N20 T=\"MILL10\" M6", 6),
            "'T=' is a Siemens word; use --reader siemens");
  EXPECT_EQ(other_language("%x0=posx", 1),
            "'%x0=' is a variable of the sender cncjs, which substitutes it while streaming; write "
            "its value");
  EXPECT_EQ(other_language("%wait", 1), "");
  EXPECT_EQ(other_language("G1 X10. F100.", 1), "");
}

TEST(OtherLanguage, TextsAndEngravingAreNamed) {
  EXPECT_EQ(other_language("M118 probing with M463 X-10", 6),
            "M118 displays a text (Marlin, Duet, Carvera), which needs brackets here; remove the "
            "line, or use (MSG, ...)");
  EXPECT_EQ(other_language("M117 P1", 1), "");
  EXPECT_EQ(other_language("M4005 V\"v0.3.0\"", 7),
            "a string in quotes is RepRapFirmware or Siemens syntax; only G-code is supported: "
            "remove the line if it causes no motion");
  EXPECT_EQ(other_language("G47 P0 (PART) X1. Y2. E10.", 23),
            "G47 engraves text (Haas), whose moves are not in the program; have the CAM system "
            "output the moves");
}

TEST(OtherLanguage, IsNamedInProgramsOfTheDefaultReader) {
  EXPECT_EQ(refusal("G1 X1 F1\nTOOL CALL 1 Z S1\n"),
            "p.nc:2:2: error: 'TOOL CALL' is Heidenhain conversational; use --reader heidenhain");
  EXPECT_EQ(refusal("N10 CYCLE81(5,0,2,-10)\n"),
            "p.nc:1:6: error: 'CYCLE' is a Siemens word; use --reader siemens");
  EXPECT_EQ(refusal("G1 X1 F100 E0.5\nM2\n"),
            "p.nc:1:12: error: an E word feeds the extruder of a 3D printer, sets the generator of "
            "wire EDM, or selects a work offset (Fadal, format 1); only milling programs with G54 "
            "... G59 are supported");
}

TEST(OtherLanguage, IsNamedByTheFormOfItsBlocks) {
  const std::string star =
      "a '*' ends blocks of Heidenhain DIN/ISO programs, which are not supported; use Heidenhain "
      "conversational or G-code of other controls";
  EXPECT_EQ(other_language("N50 G00 G40 G90 Z+250 *", 23), star);
  EXPECT_EQ(other_language("#1=#2*", 6), "");
  EXPECT_EQ(other_language("$PART.MIN%", 1),
            "'$PART.MIN%' starts an Okuma program, which is not supported; post-process for Fanuc "
            "or LinuxCNC");
  EXPECT_EQ(
      other_language("VC1=10", 1),
      "'VC1=' is an Okuma variable, which is not supported; post-process for another control");
  const std::string shopbot =
      "this is a ShopBot program (OpenSBP), which is not supported; use G-code";
  EXPECT_EQ(other_language("'SHOPBOT FILE", 1), shopbot);
  EXPECT_EQ(other_language("MS,2.0,1.0", 3), shopbot);
  EXPECT_EQ(other_language("M3,1.0,2.0", 3), shopbot);
  EXPECT_EQ(other_language("M3", 1), "");
}

// A block of words has no three letters in a row.
TEST(OtherLanguage, TextBehindTwoSlashesIsAComment) {
  EXPECT_EQ(refusal("//O0000Bracket\n//DATE=DD-MM-YY\nG0 X1.\nM2\n"), "");
  EXPECT_EQ(refusal("//G0 X1. (BRACKET)\nM2\n").substr(0, 36),
            "p.nc:1:2: error: '//' before words: ");
}

TEST(OtherLanguage, ALaserIsRefusedByName) {
  const std::string refused =
      ": error: S after M3 S0 or M4 S0 without another M3 or M4: a laser power; only milling "
      "programs are supported";
  EXPECT_EQ(refusal("M4 S0\nG0 X1.\nG1 X2. S500 F100.\nM2\n"), "p.nc:3:8" + refused);
  EXPECT_EQ(refusal("M3 S0\nG0 X1.\nS1000\nG1 X2. F100.\nM2\n"), "p.nc:3:1" + refused);
  // a spindle that is switched on with its speed, or does not turn
  EXPECT_EQ(refusal("M3 S0\nG0 X1.\nM3 S1000\nS2000\nG1 X2. F100.\nM2\n"), "");
  EXPECT_EQ(refusal("M3 S0\nG1 X2. S0 F100.\nM5\nS500\nM2\n"), "");
}

TEST(OtherLanguage, ATextThatEndsInASubroutineIsNoProgram) {
  EXPECT_EQ(refusal("O1 sub\nG0 X1\n"),
            "p.nc:2: error: the program ends while skipping to O1 from line 1");
  EXPECT_EQ(refusal("%\nO1 if [0]\nG0 X1\n%\n"),
            "p.nc:4: error: the program ends while skipping to O1 from line 2");
}

TEST(OtherLanguage, AnEmptyTextIsNoProgram) {
  for (const char* text : {"", "\n\n"}) {
    EXPECT_TRUE(refusal(text).ends_with(": error: the program is empty: it has no block"));
  }
}

}  // namespace
}  // namespace servomill::controllers::other_language_test
