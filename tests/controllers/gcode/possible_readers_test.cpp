// Words that two controls read differently are read as all those do that would read the program, or
// as the one for which the program itself says that it is.
#include "controllers/gcode/readers/possible_readers.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "controllers/gcode/readers/differences.h"
#include "tests/controllers/gcode/tolerant_reading.h"

namespace servomill::controllers::possible_readers_test {
namespace {

ProgramSetup with_tools() {
  ProgramSetup setup;
  setup.tools = ToolTable::parse("T1 P1 Z10 D2\nT2 P2 Z20 D4\n", "tools.tbl");
  return setup;
}

std::string moves(const std::string& text, Reader reader = Reader::any,
                  const ProgramSetup& setup = with_tools()) {
  const auto found = program_reader_test::read(text, reader, setup);
  return found.refusal.empty() ? program_reader_test::without_lines(found.moves) : found.refusal;
}

std::vector<std::string> warnings_of(const std::string& text) {
  std::vector<std::string> out;
  for (const Fault& one : program_reader_test::read(text, Reader::any).warnings) {
    out.push_back(to_string(one));
  }
  return out;
}

// G28 beside G0 stops LinuxCNC and grbl; the others agree on H0.
TEST(PossibleReaders, GiveTheReadingThatTheyHaveInCommon) {
  const std::string program = "G0 G28 Z0.\nG43 H0 Z1.\nM2\n";
  EXPECT_EQ(moves(program), moves("G28 Z0\nG49 G0 Z1\nM2\n", Reader::linuxcnc));
  const std::vector<std::string> found = warnings_of(program);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[1],
            "p.nc:2:5: error: G43 H0: read as no length (Fanuc, Haas, Mach), since LinuxCNC would "
            "stop at line 1, grbl at line 1");
}

TEST(PossibleReaders, AreTriedOnceForRunsThatShareTheTrials) {
  const std::string program = "G0 G28 Z0.\nG43 H0 Z1.\nM2\n";
  ProgramSetup setup = with_tools();
  setup.trials = std::make_shared<SharedTrials>();
  const std::string first = moves(program, Reader::any, setup);
  const auto found = setup.trials->found;
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(moves(program, Reader::any, setup), first);
  EXPECT_EQ(setup.trials->found, found);
}

// Behind the word, too: what stops LinuxCNC stands in line 3.
TEST(PossibleReaders, AreFoundByTheWholeProgram) {
  EXPECT_EQ(moves("T1 M6\nG43 H0\nG0 G28 Z0.\nM2\n"),
            moves("T1 M6\nG49\nG28 Z0\nM2\n", Reader::linuxcnc));
}

// LinuxCNC would read each of these, too, and go back to R.
TEST(PossibleReaders, GiveTheReadingOfTheControlThatTheProgramNames) {
  const std::string cycle = "G0 Z5.\nG81 X1. Z-2. R1. F100.\nX2.\nG80\nM30\n";
  const std::string to_R = moves(cycle, Reader::linuxcnc);
  const std::string to_start = moves("G98\n" + cycle, Reader::linuxcnc);
  ASSERT_NE(to_R, to_start);
  EXPECT_EQ(moves("%\nO0042 (PLATE)\n" + cycle + "%\n"), to_start);
  EXPECT_EQ(moves(":42\n" + cycle), to_start);
  EXPECT_EQ(moves("(Post processor: fanuc.cps)\n" + cycle), to_start);
  EXPECT_EQ(moves("; HAAS VF2\n" + cycle), to_start);
  EXPECT_EQ(moves("(Post Processor: linuxcnc_post)\n" + cycle), to_R);
  // the comment counts for more than the number
  EXPECT_EQ(moves("%\nO0042 (FOR LINUXCNC)\n" + cycle), to_R);
  EXPECT_EQ(
      warnings_of("%\nO0042 (PLATE)\n" + cycle + "%\n"),
      std::vector<std::string>(
          {"p.nc:4:14: error: a canned cycle from above R before the first G98 or G99: read as "
           "returns to the initial level (Fanuc, Haas), since the program starts with O0042, as "
           "on Fanuc and Haas; --reader selects the alternative: returns to R (LinuxCNC)"}));
}

TEST(PossibleReaders, GiveNoneWhereTheProgramNamesNoControlOrTwo) {
  const std::string cycle = "G0 Z5.\nG81 X1. Z-2. R1. F100.\nM30\n";
  const std::string refusal = both_readings(WordDifference::retract_level);
  for (const std::string head : {"(PLATE)\n", "(FANUC OR LINUXCNC)\n", "(MACHINIST: GRBLER)\n",
                                 "N10 (O0042)\n", "(MACH3)\n"}) {
    EXPECT_EQ(moves(head + cycle), "p.nc:3:14: error: " + refusal) << head;
  }
}

// G28 beside G0 leaves Mach, whose dwell is as it is set.
TEST(PossibleReaders, GiveNoneThatOneOfThemLacks) {
  EXPECT_EQ(moves("G0 G28 Z0.\nG4 P5\nM2\n"),
            "p.nc:2:4: error: " + both_readings(WordDifference::dwell_unit));
}

}  // namespace
}  // namespace servomill::controllers::possible_readers_test
