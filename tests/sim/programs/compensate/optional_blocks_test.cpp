// Blocks with '/' in programs for every control: what follows is right for both positions of the
// operator's switch, or the program is refused.
#include <regex>

#include "sim/programs/verification/verification.h"
#include "tests/sim/programs/compensate/dialect_trial.h"

namespace servomill::sim::programs::optional_blocks_test {
namespace {

const std::string kStart = "G21 G90 G17 G54\nT1 M6\nS1000 M3\nG0 X10 Y10\nG43 H1 Z20\n";

std::string written_for(Dialect dialect, const std::string& program) {
  const Trial trial = dialect_trial(dialect, kStart + program);
  const std::string text = dialect == Dialect::linuxcnc ? trial.run().program : body(trial);
  const std::string start = dialect == Dialect::linuxcnc ? "Z20\n" : "Z20.\n";
  const std::size_t found = text.find(start);
  if (found != std::string::npos) return text.substr(found + start.size());
  return text.substr(text.find("Z20\n") + 4);
}

std::string without_numbers(const std::string& text) {
  return std::regex_replace(text, std::regex("/N[0-9]+ "), "/");
}

// Named anew behind the cut: X, Y, Z and F, whether it has run or not.
const std::string kCut =
    "G1 Z2 F300\nX30\nG0 Z20\n/X40 Y20\n/M8\n/G1 Z-3 F200\n/X60\n/G0 Z25\nG0 X60 Y10\nG0 Z2\nG1 "
    "Z-1 "
    "F300\nM9\nM2\n";

TEST(OptionalBlocks, KeepTheSlashForFanuc) {
  EXPECT_EQ(
      without_numbers(written_for(Dialect::fanuc, kCut)),
      "G1 Z2. F300.\nX30.\nG0 Z20.\n/X40. Y20.\n/M8\n/G1 Z-3. F200.\n/G1 X60. F200.\n/G0 Z25.\n"
      "G0 X60. Y10.\nZ2.\nG1 Z-1. F300.\nM9\n");
}

TEST(OptionalBlocks, KeepTheSlashForSiemens) {
  EXPECT_EQ(without_numbers(written_for(Dialect::siemens, kCut)),
            "G1 Z2 F300\nX30\nG0 Z20\n/X40 Y20\n/M8\n/G1 Z-3 F200\n/G1 X60 F200\n/G0 Z25\n"
            "G0 X60 Y10\nZ2\nG1 Z-1 F300\nM9\n");
}

TEST(OptionalBlocks, KeepTheSlashForLinuxCnc) {
  EXPECT_EQ(written_for(Dialect::linuxcnc, kCut),
            "G1 Z2 F300\nX30\nG0 Z20\n/X40 Y20\n/M8\n/G1 Z-3 F200\n/G1 X60\n/G0 Z25\nG0 X60 Y10\n"
            "G0 Z2\nG1 Z-1 F300\nM9\nM2\n");
}

// Every line that a block with '/' becomes: 60 mm with an error of 10 um take more than one.
TEST(OptionalBlocks, KeepTheSlashOnEveryLineThatTheyBecome) {
  for (const Dialect dialect : {Dialect::linuxcnc, Dialect::fanuc, Dialect::siemens}) {
    Trial trial =
        dialect_trial(dialect, kStart + "/G1 X70 F300\n/G0 X10 Y10 Z20\nG0 X20 Y20\nM2\n");
    trial.request.error_file =
        written("wave.toml",
                "[errors.w]\nEYX = { harmonic = { amplitude_um = 10.0, period_mm = 60.0 } }\n");
    const std::string text = trial.run().program;
    const std::regex line("(^|\n)/[^\n]*X[^\n]*");
    const auto lines = std::distance(std::sregex_iterator(text.begin(), text.end(), line), {});
    EXPECT_GT(lines, 5) << text;
    EXPECT_EQ(text.find("\nG1"), std::string::npos) << text;
  }
}

// A hole of a canned cycle that the operator may leave out.
TEST(OptionalBlocks, LeaveHolesOut) {
  const std::string holes = "G99 G81 X10 Y10 Z-3 R2 F100\n/X20 Y20\nX40 Y40\nG80\nM2\n";
  const std::string text = without_numbers(written_for(Dialect::fanuc, holes));
  EXPECT_NE(text.find("G0 Z2.\n/X20. Y20.\n/G1 X20. Y20. Z-3.\n/G0 Z2.\n/X20. Y20.\n"
                      "X40. Y40.\nG1 Z-3.\n"),
            std::string::npos)
      << text;
}

// M8 is not said again behind the tool change where it has been left out.
TEST(OptionalBlocks, RestateTheirCoolantWithTheSlash) {
  const std::string text = without_numbers(
      written_for(Dialect::fanuc, "/M8\nG0 X20\nT2 M6\nS800 M3\nG0 X30 Y30\nG43 H2 Z20\nM9\nM2\n"));
  EXPECT_NE(text.find("S800 M3\n/M8\nG0 X30. Y30.\n"), std::string::npos) << text;
}

TEST(OptionalBlocks, MustNotStopACoolantThatGoesOnBehindAToolChange) {
  EXPECT_EQ(refusal(Dialect::fanuc,
                    kStart + "M8\n/M9\nG0 X20\nT2 M6\nS800 M3\nG0 X30 Y30\nG43 H2 Z20\nM2\n"),
            "plate.ngc:11: error: needs the coolant that a block with '/' has switched off; remove "
            "the slash; it cannot be expressed in fanuc");
}

// The switch may be in either position: a slash that is lost, or one too many, is found.
TEST(OptionalBlocks, AreVerifiedForBothPositionsOfTheSwitch) {
  for (const Dialect dialect : {Dialect::linuxcnc, Dialect::fanuc, Dialect::siemens}) {
    const Trial trial = dialect_trial(dialect, kStart + kCut);
    const std::string text = trial.run().program;
    const std::regex slash("(^|\n)/");
    int tried = 0;
    for (auto i = std::sregex_iterator(text.begin(), text.end(), slash);
         i != std::sregex_iterator(); ++i) {
      std::string lost = text;
      lost.erase(static_cast<std::size_t>(i->position(0) + i->length(0)) - 1, 1);
      EXPECT_THROW(verify_compensated(trial.request, lost), InputError) << lost;
      ++tried;
    }
    EXPECT_EQ(tried, 5);
    std::string more = text;
    more.insert(more.rfind(dialect == Dialect::linuxcnc ? "\nG1 Z-1" : "G1 Z-1") + 1, "/");
    EXPECT_THROW(verify_compensated(trial.request, more), InputError);
  }
}

std::string why(Dialect dialect, const std::string& program) {
  return refusal(dialect, kStart + program);
}

const std::string kRemedy =
    "remove the slash where they must run, or omit these blocks with --block-delete";

TEST(OptionalBlocks, AreRefusedWhereTheRestDependsOnThem) {
  const std::string slash =
      "plate.ngc:6:1: error: the rest of the program depends on whether the operator skips blocks "
      "with '/'; remove the slash, or omit these blocks with --block-delete";
  for (const Dialect dialect : {Dialect::linuxcnc, Dialect::fanuc, Dialect::siemens}) {
    EXPECT_EQ(why(dialect, "/T2 M6\nG0 X20\nM2\n"), slash);
    EXPECT_EQ(why(dialect, "/#1 = 5\nG0 X20\nM2\n"), slash);
    EXPECT_EQ(why(dialect, "/M30\nG0 X20\nM2\n"), slash);
  }
  EXPECT_EQ(why(Dialect::heidenhain, "/G0 X20\nG0 X30 Y30\nM2\n"),
            "plate.ngc:6:1: error: blocks with '/' are undocumented for this control; remove the "
            "slash, or omit these blocks with --block-delete");
}

TEST(OptionalBlocks, AreRefusedWhereTheyLeaveAnotherState) {
  EXPECT_EQ(why(Dialect::fanuc, "/G91\nG0 X30\nG90\nM2\n"),
            "plate.ngc:7: error: the program written for fanuc differs in effect from \"G0 X30\": "
            "X must end at machine position 230.00000, but ends at 240.00000 (its line 26, \"N16 "
            "X40.\"; EVO=0 TOS=0 LRP=0 TLB=0 IS-B); that is with the blocks with '/' left out: " +
                kRemedy);
  for (const std::string block :
       {"/M5\nG1 X30 F100", "/G43 H2\nG0 Z30", "G1 X12 F100\n/G0 X14\nX20",
        "G1 X12 F100\n/G1 X14 F500\nX20 Y20"}) {
    EXPECT_NE(why(Dialect::fanuc, block + "\nM2\n").find(kRemedy), std::string::npos) << block;
  }
}

// The lines of a subroutine have no slash of their own.
TEST(OptionalBlocks, DoNotCallSubroutines) {
  for (const Dialect dialect : {Dialect::linuxcnc, Dialect::fanuc, Dialect::siemens}) {
    EXPECT_NE(why(dialect, "o100 sub\nG0 X20\no100 endsub\n/o100 call\nG0 Y30\nM2\n"), "taken");
  }
}

// G1 without F has no meaning where the block that gives F is left out.
TEST(OptionalBlocks, AreRefusedWhereTheProgramCannotRunWithoutThem) {
  EXPECT_EQ(why(Dialect::linuxcnc, "/F100\nG1 X20\nM2\n"),
            "plate.ngc:7:1: error: G1 before the first F: Mach keeps the last feed, other controls "
            "raise an alarm; program F, or set the feed with --feed or program.first_feed of a "
            "scenario; that is with the blocks with '/' left out: " +
                kRemedy);
}

// Behind a stop X and Y are where the operator has left them. Blocks with '/' that name them have
// no need of their names again.
TEST(OptionalBlocks, NameLostAxesForTheBlocksWithASlashBehindThem) {
  const std::string program =
      "M0\nG0 Z25\n/X40 Y20\n/G1 Z-3 F200\n/X60\n/G0 Z25\nG0 X70 Y10\nG0 Z2\nM2\n";
  EXPECT_EQ(without_numbers(written_for(Dialect::siemens, program)),
            "M0\nM3\nZ25\n/X40 Y20\n/G1 X40 Y20 Z-3 F200\n/G1 X60 Y20 F200\n/G0 Z25\n"
            "G0 X70 Y10\nZ2\n");
  // with errors, a rapid to the programmed X and Y would leave the corrected ones
  for (const Dialect dialect : {Dialect::fanuc, Dialect::siemens}) {
    Trial trial = dialect_trial(dialect, kStart + program);
    trial.request.error_file.clear();  // those of the machine file
    EXPECT_NO_THROW(trial.run());
  }
}

TEST(OptionalBlocks, MustNotBeAloneInNamingLostAxes) {
  const std::string why_not =
      "moves Z after a tool change or stop that may have moved X, Y, and the blocks between them "
      "depend on '/'; program X, Y in a rapid without '/' between it and this line; it cannot be "
      "expressed in siemens";
  EXPECT_EQ(why(Dialect::siemens, "M0\n/G0 X40 Y20\nG0 Z10\nM2\n"),
            "plate.ngc:8: error: " + why_not);
  // Z comes down from 30 or goes up from 20
  EXPECT_EQ(why(Dialect::siemens, "/G0 Z30\nM0\nG0 Z25\nX40 Y20\nM2\n"),
            "plate.ngc:8: error: " + why_not);
}

// Skipped, the stop has moved nothing.
TEST(OptionalBlocks, BringBackWhatAStopWithASlashHasLost) {
  EXPECT_EQ(without_numbers(written_for(Dialect::siemens, "/M0\nG0 Z10\nX40 Y20\nM2\n")),
            "/M0\nM3\n/X10 Y10\nZ10\nX40 Y20\n");
}

// Up first, or down last: which, the operator decides.
TEST(OptionalBlocks, MustNotDecideAboutTheOrderOfARapid) {
  EXPECT_EQ(why(Dialect::fanuc, "G1 Z-5 F100\n/G0 Z30\nG0 X30 Y30 Z20\nM2\n"),
            "plate.ngc:8: error: moves Z and other axes by rapid, up or down depending on blocks "
            "with '/'; program Z in a separate rapid before; it cannot be expressed in fanuc");
  EXPECT_NE(written_for(Dialect::fanuc, "G1 Z-5 F100\n/G0 Z10\nG0 X30 Y30 Z20\nM2\n")
                .find("Z20.\nX30. Y30.\n"),
            std::string::npos);
}

}  // namespace
}  // namespace servomill::sim::programs::optional_blocks_test
