// Moves whose words two controls read differently, in surveys, and arcs with the other kind of
// centre.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/interpreter.h"
#include "tests/controllers/gcode/tolerant_reading.h"

namespace servomill::controllers {
namespace {

using program_reader_test::besides_unit;

ProgramSetup setup_for(Reader reader) {
  ProgramSetup setup;
  setup.reader = reader;
  return setup;
}

// The end of each move in work coordinates, or the first fault.
std::string moves_of(const std::string& text, const ProgramSetup& setup) {
  std::string out;
  try {
    Interpreter interpreter(text, "p.nc", setup);
    while (const Move* move = interpreter.next()) {
      const std::string line = canon_json(*move);
      const std::size_t end = line.find("\"end\":");
      if (end == std::string::npos) continue;
      out += line.substr(line.find("\"t\""), line.find(',') - 1) + line.substr(end) + "\n";
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return out;
}

// Words with two readings that end at the same place do not end a survey.
TEST(Surveys, GoOnWhereBothReadingsEndAtTheSamePlace) {
  ProgramSetup setup = setup_for(Reader::any);
  setup.accepts_unknown_positions = true;
  const auto warnings_of = [&](const std::string& text) {
    Interpreter interpreter(text, "p.nc", setup);
    while (interpreter.next() != nullptr) {
    }
    return to_string(besides_unit(interpreter.warnings()).back());
  };
  const std::string start = "F100.\nX1.\nM2\n";
  EXPECT_EQ(moves_of(start, setup), moves_of("F100\nG0 X1\nM2\n", setup_for(Reader::linuxcnc)));
  EXPECT_EQ(warnings_of(start),
            "p.nc:2:1: error: axis words before the first G0, G1, G2, G3: a rapid (grbl, Haas), or "
            "a rapid or a feed move, depending on a control setting (Fanuc, Mach); choose with "
            "--reader; treated as a rapid here: the end of the move is the same");
  const std::string home = "G0 X5.\nG91 G28 X0. Z9. G90\nX1.\nM2\n";
  EXPECT_EQ(moves_of(home, setup),
            moves_of("G0 X5\nG91\nG28 X0 Z0\nG90\nG0 X1\nM2\n", setup_for(Reader::linuxcnc)));
  EXPECT_EQ(warnings_of("G0 X5.\nG91 G28 X0. Z9. G90\nM2\n"),
            "p.nc:2:17: error: G90 and G91 with G28 or G30: it is undocumented which one applies "
            "to the intermediate point; use two blocks; omitted here");
}

TEST(Surveys, GoOnBeforeTheFirstFeed) {
  ProgramSetup setup = setup_for(Reader::any);
  setup.accepts_unknown_feeds = true;
  for (const std::string unit : {"G20 ", "G21 "}) {
    Interpreter interpreter(unit + "G1 X1.\nX2.\nF100. X3.\nM2\n", "p.nc", setup);
    std::vector<bool> unknown;
    while (const Move* move = interpreter.next()) {
      if (move->kind == MoveKind::feed) unknown.push_back(std::isnan(move->feed));
    }
    EXPECT_EQ(unknown, (std::vector<bool>{true, true, false}));
    EXPECT_EQ(to_string(besides_unit(interpreter.warnings()).front()),
              "p.nc:1:5: error: G1 before the first F: Mach keeps the last feed, other controls "
              "raise an alarm; program F, or set the feed with --feed or program.first_feed of a "
              "scenario; the cycle time is unknown");
  }
}

TEST(Arcs, ThatFitTheOtherKindOfCentreSaySo) {
  const std::string fault =
      moves_of("G0 X10. Y0.\nG3 X0. Y10. I0. J0. F9.\nM2\n", setup_for(Reader::any));
  EXPECT_NE(
      fault.find(
          "; as absolute centre (G90.1) I, J and K fit: if intended, program G90.1 at the start"),
      std::string::npos)
      << fault;
  const std::string other =
      moves_of("G90.1\nG0 X10. Y0.\nG3 X0. Y10. I-10. J0. F9.\nM2\n", setup_for(Reader::any));
  EXPECT_NE(other.find("; as distances from the start (G91.1) I, J and K fit"), std::string::npos)
      << other;
}

// NX has posts that give the way from the centre to the start.
TEST(Arcs, WhoseCentreHasTheWrongSignsSaySo) {
  const std::string fault =
      moves_of("G0 X10. Y0.\nG3 X0. Y10. I10. J0. F9.\nM2\n", setup_for(Reader::any));
  EXPECT_NE(
      fault.find("; with opposite signs I, J and K fit: the post-processor outputs the vector from "
                 "the centre to the start, but must output that from the start to the centre"),
      std::string::npos)
      << fault;
}

std::vector<std::string> warnings_of(const std::string& text, Reader reader) {
  Interpreter interpreter(text, "p.nc", setup_for(reader));
  interpreter.rest();
  std::vector<std::string> out;
  for (const Fault& one : besides_unit(interpreter.warnings())) out.push_back(to_string(one));
  return out;
}

// Fanuc, parameter 1008#1 (ROA, RAB): forward by 3 degrees.
TEST(Moves, OfMoreThanHalfATurnAreReportedOnce) {
  const std::string program = "G0 B359.\nB2.\nB359. A10.\nA-171. B300.\nG91 B200.\nM2\n";
  const auto turns = [](const std::string& place, const std::string& what) {
    return place + ": error: " + what +
           " degrees: read as the difference of the angles (LinuxCNC); a rollover axis "
           "(Fanuc, parameter 1008) takes the shorter direction";
  };
  EXPECT_EQ(warnings_of(program, Reader::mach),
            std::vector<std::string>(
                {turns("p.nc:1:4", "B rotates by 359"), turns("p.nc:4:1", "A rotates by 181")}));
  EXPECT_TRUE(warnings_of(program, Reader::linuxcnc).empty());
  EXPECT_TRUE(warnings_of("G0 B180.\nB0.\nB-180.\nM2\n", Reader::mach).empty());
}

// 25.4 is at stake.
TEST(Lengths, BeforeTheirUnitAreReportedOnce) {
  const auto reported = [](const std::string& text, Reader reader) {
    Interpreter interpreter(text, "p.nc", setup_for(reader));
    interpreter.rest();
    std::vector<std::string> out;
    for (const Fault& one : interpreter.warnings()) {
      if (one.message.find("G20 or G21") != std::string::npos) out.push_back(to_string(one));
    }
    return out;
  };
  EXPECT_EQ(
      reported("G0 Z0.\nA3. Z1.\nX2.\nG20 X1.\nM2\n", Reader::any),
      std::vector<std::string>({"p.nc:2:5: error: a length before G20 or G21: read in millimetres; "
                                "controls use the unit set last; program G20 or G21"}));
  EXPECT_EQ(reported("G0 X2.\nM2\n", Reader::haas).size(), 1u);
  EXPECT_TRUE(reported("G20 G0 X1.\nM2\n", Reader::any).empty());
  EXPECT_TRUE(reported("G0 X1.\nM2\n", Reader::grbl).empty());
  EXPECT_TRUE(reported("G0 X1.\nM2\n", Reader::linuxcnc).empty());
}

// It does not end there on a control.
TEST(Programs, ThatEndWithM99AreWarnedOf) {
  const std::string program = "G0 X1.\nM99\n";
  EXPECT_EQ(warnings_of(program, Reader::any),
            std::vector<std::string>({"p.nc:2:1: error: M99 in a main program: treated as program "
                                      "end; a control repeats the program endlessly"}));
  EXPECT_TRUE(warnings_of(program, Reader::linuxcnc).empty());
  EXPECT_TRUE(warnings_of("M98 P1\nM2\nO1\nG0 X1.\nM99\n", Reader::any).empty());
}

// LinuxCNC passes over them, other controls do not.
TEST(Calls, WithOtherWordsBehindThemAreRefused) {
  const std::string callee = "\nM2\nO1\nG0 Y1.\nM99\n",
                    choose = ", or choose with --reader linuxcnc";
  for (const Reader reader : {Reader::any, Reader::haas, Reader::mach}) {
    EXPECT_EQ(moves_of("G0\nM98 P1 X5." + callee, setup_for(reader)),
              "p.nc:2:8: error: X after M98: no effect (LinuxCNC), or executed before the call "
              "(Fanuc, Haas); program it in a separate block" +
                  choose);
    EXPECT_EQ(moves_of("M98 P1 Q5" + callee, setup_for(reader)),
              "p.nc:1:8: error: Q with M98: no effect (LinuxCNC), or the block where the "
              "subprogram starts (Fanuc); remove it" +
                  choose);
  }
  EXPECT_EQ(moves_of("G0\nM98 P1 X5." + callee, setup_for(Reader::linuxcnc)),
            moves_of("G0\nG0 Y1\nM2\n", setup_for(Reader::linuxcnc)));
}

}  // namespace
}  // namespace servomill::controllers
