// Programs and lines that are no G-code are refused by the name of their language.
#include "controllers/gcode/other_language.h"

#include <gtest/gtest.h>

#include <string>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/input_error.h"
#include "tests/controllers/gcode/tolerant_reading.h"

namespace servomill::controllers::other_language_test {
namespace {

// A word may mean something else there (G4 F, G64, D): none is read by the rules of another
// control unless the user names it.
TEST(OtherLanguage, SiemensProgramsAreRefusedByName) {
  const auto fault = [](const std::string& text, const std::string& file, Reader reader) {
    ProgramSetup setup;
    setup.reader = reader;
    try {
      interpret(text, file, setup);
    } catch (const InputError& error) {
      return to_string(error.faults().front());
    }
    return std::string();
  };
  const std::string refusal =
      ":1:1: error: this is a Siemens program; programs in G-code are read here: let the "
      "post-processor write for Fanuc or LinuxCNC, or, where the program has no word of Siemens' "
      "own, name the control whose rules it follows with --reader";
  for (const std::string file : {"SHAFT.MPF", "shaft.mpf", "hole.spf"}) {
    EXPECT_EQ(fault("G0 X1\nM2\n", file, Reader::any), file + refusal);
  }
  EXPECT_EQ(fault("%_N_SHAFT_MPF\n;$PATH=/_N_MPF_DIR\nG0 X1\nM2\n", "p.nc", Reader::any),
            "p.nc" + refusal);
  EXPECT_EQ(fault("G0 X1.\nM2\n", "shaft.mpf", Reader::fanuc), "");
  EXPECT_EQ(fault("G0 X1\nM2\n", "mpf", Reader::any), "");
}

TEST(OtherLanguage, LinesAreNamedByTheWordsThatGiveThemAway) {
  EXPECT_EQ(other_language("12 CYCL DEF 200 DRILLING", 1),
            "'CYCL DEF' is Heidenhain conversational; --reader heidenhain reads it");
  EXPECT_EQ(other_language("N20 T=\"MILL10\" M6", 6),
            "'T=' is a word of Siemens' language; programs in G-code are read here");
  EXPECT_EQ(other_language("%x0=posx", 1),
            "'%x0=' is a variable of the sender cncjs, which replaces it while it streams; write "
            "its value");
  EXPECT_EQ(other_language("%wait", 1), "");
  EXPECT_EQ(other_language("G1 X10. F100.", 1), "");
}

TEST(OtherLanguage, TextsAndEngravingAreNamed) {
  EXPECT_EQ(other_language("M118 probing with M463 X-10", 6),
            "M118 shows a text (Marlin, Duet, Carvera), which is not read without brackets; take "
            "the line out, or write (MSG, ...)");
  EXPECT_EQ(other_language("M117 P1", 1), "");
  EXPECT_EQ(other_language("M4005 V\"v0.3.0\"", 7),
            "a text in quotes is of RepRapFirmware or Siemens; programs in G-code are read here: "
            "take the line out if it moves nothing");
  EXPECT_EQ(other_language("G47 P0 (PART) X1. Y2. E10.", 23),
            "G47 engraves a text (Haas), whose letters are not in the program; let the CAM system "
            "write their moves");
}

TEST(OtherLanguage, IsNamedInProgramsOfTheDefaultReader) {
  using program_reader_test::refusal;
  EXPECT_EQ(
      refusal("G1 X1 F1\nTOOL CALL 1 Z S1\n"),
      "p.nc:2:2: error: 'TOOL CALL' is Heidenhain conversational; --reader heidenhain reads it");
  EXPECT_EQ(refusal("N10 CYCLE81(5,0,2,-10)\n"),
            "p.nc:1:6: error: 'CYCLE' is a word of Siemens' language; programs in G-code are read "
            "here");
  EXPECT_EQ(refusal("G1 X1 F100 E0.5\nM2\n"),
            "p.nc:1:12: error: an E word feeds the extruder of a printer, or sets the generator of "
            "wire EDM; programs for milling are read here");
}

}  // namespace
}  // namespace servomill::controllers::other_language_test
