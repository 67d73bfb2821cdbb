// Words that two controls read differently: none is read in silence. Each difference has a program;
// the reader `any` refuses it with both readings, a reader that has one of them reads it so.
#include "controllers/gcode/readers/differences.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/input_error.h"
#include "tests/controllers/gcode/tolerant_reading.h"

namespace servomill::controllers {
namespace {

using program_reader_test::besides_unit;
using program_reader_test::without_lines;

std::string moves_of(const std::string& text, ProgramSetup setup) {
  std::string out;
  try {
    Interpreter interpreter(text, "p.nc", std::move(setup));
    while (const Move* move = interpreter.next()) out += canon_json(*move) + "\n";
  } catch (const InputError& error) {
    return error.what();
  }
  return without_lines(out);
}

ProgramSetup setup_for(Reader reader, DecimalPoint decimal_point = DecimalPoint::calculator) {
  ProgramSetup setup;
  setup.reader = reader;
  const bool depends = reader == Reader::fanuc || reader == Reader::haas;
  if (depends) setup.decimal_point = decimal_point;
  setup.tools = ToolTable::parse("T1 P1 Z10 D2\nT2 P2 Z20 D4\n", "tools.tbl");
  return setup;
}

std::vector<std::string> warnings_of(const std::string& text, ProgramSetup setup = {}) {
  setup.reader = Reader::any;
  Interpreter interpreter(text, "p.nc", std::move(setup));
  interpreter.rest();
  std::vector<std::string> out;
  for (const Fault& one : besides_unit(interpreter.warnings())) out.push_back(to_string(one));
  return out;
}

struct Example {
  WordDifference difference;
  std::string program;
  std::string place;                    // of the refusal
  std::array<std::string, 2> readings;  // as LinuxCNC has it; empty: no reader reads it so
};

const std::vector<Example>& examples() {
  using enum WordDifference;
  static const std::vector<Example> all = {
      {dwell_unit, "G4 P2\nM2\n", "p.nc:1:4", {"G4 P2\nM2\n", "G4 P0.002\nM2\n"}},
      {dwell_increments, "G4 X1500\nM2\n", "p.nc:1:4", {}},
      {cycle_dwell_unit,
       "G0 Z5.\nG99 G82 X1. Z-2. R1. P500 F100.\nM2\n",
       "p.nc:2:22",
       {"G0 Z5\nG99 G82 X1 Z-2 R1 P500 F100\nM2\n", "G0 Z5\nG99 G82 X1 Z-2 R1 P.5 F100\nM2\n"}},
      {length_offset_zero,
       "T1 M6\nG43 H0\nG0 Z1.\nM2\n",
       "p.nc:2:5",
       {"", "T1 M6\nG49\nG0 Z1\nM2\n"}},
      {stored_home, "G28.1\nM2\n", "p.nc:1:1", {"G28.1\nM2\n", ""}},
      {retract_level,
       "G0 Z5.\nG81 X1. Z-2. R1. F100.\nM2\n",
       "p.nc:2:14",
       {"", "G0 Z5\nG98 G81 X1 Z-2 R1 F100\nM2\n"}},
      {subprogram_digits,
       "M98 P20100\nM2\nO100\nG0 X1.\nM99\nO20100\nG0 X9.\nM99\n",
       "p.nc:1:5",
       {"G0 X9\nM2\n", "G0 X1\nX1\nM2\n"}},
      {lone_machine_coordinates, "G53\nG0 X1.\nM2\n", "p.nc:1:1", {"G0 X1\nM2\n", ""}},
      {preset_words,
       "G92 X1. Y2.\nG92.1 X0.\nG0 X1. Y1.\nM2\n",
       "p.nc:2:1",
       {"", "G92 X1 Y2\nG52 X0\nG0 X1 Y1\nM2\n"}},
      {missing_diameter_offset,
       "T1 M6\nG41 G1 X10. F100.\nG40 X20.\nM2\n",
       "p.nc:2:1",
       {"T1 M6\nG41 G1 X10 F100\nG40 X20\nM2\n", "T1 M6\nG1 X10 F100\nX20\nM2\n"}},
      {tool_table_input,
       "G10 L10 P1 R50.\nT1 M6\nG43 H1\nG0 Z1.\nM2\n",
       "p.nc:1:5",
       {"", "G10 L1 P1 Z50\nT1 M6\nG43 H1\nG0 Z1\nM2\n"}},
      {work_offset_input,
       "G10 L20 P1 X5.\nG0 X1.\nM2\n",
       "p.nc:1:5",
       {"G10 L20 P1 X5\nG0 X1\nM2\n", "G0 X1\nM2\n"}},
      {cycle_distance,
       "G0 Z5.\nG99 G81 X1. Z-2. R1. F100.\nG91 X2.\nM2\n",
       "p.nc:3:1",
       {"", "G0 Z5\nG99 G81 X1 Z-2 R1 F100\nG91 X2 R-4 Z-3\nM2\n"}},
      {polar_centre,
       "G0 X10. Y10.\nG16\nX10. Y0.\nM2\n",
       "p.nc:2:1",
       {"G0 X10 Y10\nX10 Y0\nM2\n", "G0 X10 Y10\nX20 Y10\nM2\n"}},
      {feed_beside_unit, "G20 G1 X1. F10.\nM2\n", "p.nc:1:12", {"", "G20\nG1 X1 F10\nM2\n"}},
      {override_codes, "M50 P0\nG0 X1.\nM2\n", "p.nc:1:1", {}},
      {start_motion, "F100.\nX1.\nM2\n", "p.nc:2:1", {"F100\nG0 X1\nM2\n", ""}},
      {decimal_point, "G0 X1000\nM2\n", "p.nc:1:4", {}},
      {scale_factor, "G51 P2\nG0 X1.\nM2\n", "p.nc:1:5", {"G0 X2\nM2\n", "G0 X0.002\nM2\n"}},
      {circular_pocket,
       "G12 I4. F300.\nM2\n",
       "p.nc:1:1",
       {"F300\nG1 X4\nG2 I-4\nG1 X0\nM2\n", ""}},
      {common_variable, "IF[#100EQ#0]GOTO9\nG0 X1.\nN9 M2\n", "p.nc:1:4", {"M2\n", ""}},
      {angle_range,
       "#1=ATAN[-1.]/[1.]\nIF[#1LT0]GOTO9\nG0 A#1\nN9 M2\n",
       "p.nc:1:4",
       {"G0 A315\nM2\n", ""}},
      {remainder,
       "#1=-7. MOD 3.\nIF[#1LT-5]GOTO9\nG0 X#1\nN9 M2\n",
       "p.nc:1:8",
       {"G0 X-1\nM2\n", ""}},
      {variable_dwell,
       "#1=500\nIF[#1LT0]GOTO9\nG4 P#1\nN9 M2\n",
       "p.nc:3:4",
       {"G4 P0.5\nM2\n", ""}},
      {argument_point, "G65 P1 X10\nM2\nO1\nG0 X#24\nM99\n", "p.nc:1:8", {}},
      {return_block,
       "M98 P100\nG0 Y9.\nN5 M2\nO100\nM99 P5\nG0 X9.\nIF[1EQ1]GOTO5\nN5 M99\n",
       "p.nc:5:1",
       {"M2\n", "G0 Y9\nM2\n"}},
      {system_zero,
       "G55\nG10 L2 P0 X0.\nG0 X1.\nM2\n",
       "p.nc:2:8",
       {"G55\nG10 L2 P2 X0\nG0 X1\nM2\n", "G55 G0 X1\nM2\n"}},
      {incremental_input,
       "G10 L2 P1 X2.\nG91 G10 L2 P1 X5.\nG90 G0 X1.\nM2\n",
       "p.nc:2:5",
       {"G10 L2 P1 X5\nG0 X1\nM2\n", "G10 L2 P1 X7\nG0 X1\nM2\n"}},
      {cycle_from_below,
       "G0 Z-5.\nG99 G81 X10. Y5. Z-7. R2. F100.\nM2\n",
       "p.nc:2:1",
       {"G0 Z-5\nG99 G81 X10 Y5 Z-7 R2 F100\nM2\n",
        "G0 Z-5\nX10 Y5\nG99 G81 X10 Y5 Z-7 R2 F100\nM2\n"}},
  };
  return all;
}

TEST(WordDifferences, HaveAProgramEach) {
  for (const WordDifferenceEntry& entry : word_differences()) {
    EXPECT_TRUE(std::any_of(examples().begin(), examples().end(), [&](const Example& one) {
      return one.difference == entry.difference;
    })) << entry.found;
    EXPECT_FALSE(entry.source.empty()) << entry.found;
  }
}

TEST(WordDifferences, AreRefusedWithBothReadings) {
  for (const Example& one : examples()) {
    // neither is refused, as AreWarnedOf... show
    if (one.difference == WordDifference::override_codes ||
        one.difference == WordDifference::lone_machine_coordinates) {
      continue;
    }
    SCOPED_TRACE(one.program);
    // lengths are in millimetres unless a control that counts increments is chosen
    const bool is_of_fanuc = one.difference == WordDifference::decimal_point;
    const Reader reader = is_of_fanuc ? Reader::fanuc : Reader::any;
    const bool is_called = one.difference == WordDifference::return_block;
    const std::string stack = is_called ? "; in O100, called in p.nc:1" : "";
    EXPECT_EQ(moves_of(one.program, setup_for(reader, DecimalPoint::unset)),
              one.place + ": error: " + both_readings(one.difference) + stack);
  }
}

TEST(WordDifferences, AReaderHasOneOfThem) {
  for (const Example& one : examples()) {
    for (const Reader reader : {Reader::fanuc, Reader::haas, Reader::mach, Reader::grbl}) {
      if (one.difference == WordDifference::decimal_point ||
          one.difference == WordDifference::dwell_increments ||
          one.difference == WordDifference::argument_point ||
          one.difference == WordDifference::override_codes) {
        continue;
      }
      SCOPED_TRACE(one.program + std::string(kReaders[static_cast<std::size_t>(reader)]));
      const std::string found = moves_of(one.program, setup_for(reader));
      const auto chosen = reading_of(one.difference, reader);
      const std::string plain = chosen ? one.readings[static_cast<std::size_t>(*chosen)] : "";
      if (plain.empty()) {
        EXPECT_NE(found.find(": error: "), std::string::npos) << found;
      } else {
        EXPECT_EQ(found, moves_of(plain, setup_for(Reader::linuxcnc)));
      }
    }
  }
}

// Without a move in either reading, so that the program runs.
TEST(WordDifferences, AreWarnedOfInOverridesWhichMoveNothing) {
  const std::string program = "M50 P0\nG0 X1.\nM2\n";
  for (const Reader reader : {Reader::any, Reader::fanuc, Reader::haas, Reader::mach}) {
    EXPECT_EQ(moves_of(program, setup_for(reader)),
              moves_of("G0 X1\nM2\n", setup_for(Reader::linuxcnc)));
  }
  EXPECT_EQ(moves_of(program, setup_for(Reader::grbl)),
            "p.nc:1:1: error: M50 is not supported by grbl");
  EXPECT_EQ(warnings_of(program),
            std::vector<std::string>(
                {"p.nc:1:1: error: " + both_readings(WordDifference::override_codes) +
                 "; no axis moves while the program runs"}));
}

TEST(WordDifferences, AreWarnedOfInALoneG53BeforeAMoveWithoutAWorkOffset) {
  EXPECT_EQ(moves_of("G53\nG0 X1.\nM2\n", setup_for(Reader::any)),
            moves_of("G0 X1\nM2\n", setup_for(Reader::linuxcnc)));
  EXPECT_EQ(warnings_of("G53 G0\nX1.\nM2\n"),
            std::vector<std::string>(
                {"p.nc:2:1: error: G53 without axis words: read as no effect (LinuxCNC, grbl, "
                 "Fanuc, Haas, Mach), as on all controls that accept this program"}));
  EXPECT_TRUE(warnings_of("G53 G0\nG55\nX1.\nG0 G53 G54 G90\nX1.\nM2\n").empty());
}

TEST(WordDifferences, AreRefusedInG53UnderG91) {
  const std::string refusal =
      "G53 with G91: a machine position (an error on LinuxCNC), or a distance (Mitsubishi M700V p. "
      "508); program G90";
  EXPECT_EQ(moves_of("G91\nG53 G0 Z0\nM2\n", setup_for(Reader::any)),
            "p.nc:2:1: error: " + refusal);
  EXPECT_EQ(moves_of("G91\nG90 G53 G0 Z0.\nM2\n", setup_for(Reader::haas)),
            moves_of("G53 G0 Z0\nM2\n", setup_for(Reader::linuxcnc)));
}

// A function of the builder must not be lost where the program is written again.
TEST(MachineFunctions, BecomeCommentsWithAWarning) {
  ProgramSetup setup = setup_for(Reader::any);
  Interpreter interpreter("G0 X1. M10\nM88\nG1 X2. F100. (M10) M11\nM2\n", "p.nc", setup);
  std::vector<std::string> lines;
  while (const auto block = interpreter.next_block()) lines.emplace_back(block->text);
  EXPECT_EQ(lines,
            std::vector<std::string>({"G0 X1. (M10)", "(M88)", "G1 X2. F100. (M10) (M11)", "M2"}));
  ASSERT_EQ(besides_unit(interpreter.warnings()).size(), 3u);
  EXPECT_EQ(besides_unit(interpreter.warnings())[0].message,
            sentence(ReaderRule::machine_function) +
                "; M10 becomes a comment, also in rewritten programs");
  EXPECT_EQ(to_string(besides_unit(interpreter.warnings())[1]),
            "p.nc:2:1: error: M88 also becomes a comment");
  EXPECT_EQ(to_string(besides_unit(interpreter.warnings())[2]),
            "p.nc:3:20: error: M11 also becomes a comment");
}

TEST(MachineFunctions, OfTheBuilderAreRefusedUnlessTheUserNamesThem) {
  EXPECT_EQ(moves_of("M82\nG0 X1.\nM2\n", setup_for(Reader::any)),
            "p.nc:1:1: error: unknown M code M82: a machine-builder function, which may mirror or "
            "move an axis; if M82 does not, pass --ignore-code M82, or remove it");
  EXPECT_EQ(moves_of("M82\nG0 X1.\nM2\n", setup_for(Reader::grbl)),
            "p.nc:1:1: error: M82 is not supported by grbl");
  ProgramSetup setup = setup_for(Reader::any);
  setup.ignored_codes = {82};
  EXPECT_EQ(moves_of("M82\nG0 X1.\nM2\n", setup),
            moves_of("G0 X1\nM2\n", setup_for(Reader::linuxcnc)));
  setup.reader = Reader::linuxcnc;
  EXPECT_NE(moves_of("M82\nG0 X1.\nM2\n", setup).find("unknown M code M82"), std::string::npos);
}

TEST(MachineFunctions, MotorsAreSwitchedOnByTheUsersWord) {
  EXPECT_EQ(moves_of("M17\nG0 X1.\nM2\n", setup_for(Reader::any)),
            "p.nc:1:1: error: M17: ends a Siemens subprogram (use M99), or switches motors on "
            "(pass --ignore-code M17, or remove it)");
  ProgramSetup setup = setup_for(Reader::any);
  setup.ignored_codes = {17};
  EXPECT_TRUE(ignored_code("M17").fault.empty());
  EXPECT_EQ(moves_of("M17\nG0 X1.\nM2\n", setup),
            moves_of("G0 X1\nM2\n", setup_for(Reader::linuxcnc)));
}

TEST(Dwells, InWordsOfOtherControlsAreUnknown) {
  constexpr std::string_view kBoth =
      "G4 S: seconds (Marlin), or spindle revolutions (Siemens); use G4 P";
  EXPECT_EQ(moves_of("G4 S4\nM2\n", setup_for(Reader::any)),
            "p.nc:1:4: error: " + std::string(kBoth));
  ProgramSetup setup = setup_for(Reader::any);
  setup.accepts_unknown_dwells = true;
  Interpreter interpreter("S100\nG4 S4\nG0 X1.\nM2\n", "p.nc", setup);
  const auto moves = interpreter.rest();
  const auto dwell = std::find_if(moves.begin(), moves.end(),
                                  [](const Move& move) { return move.kind == MoveKind::dwell; });
  ASSERT_NE(dwell, moves.end());
  EXPECT_TRUE(std::isnan(dwell->value));
  ASSERT_EQ(besides_unit(interpreter.warnings()).size(), 1u);
  EXPECT_EQ(besides_unit(interpreter.warnings())[0].message,
            std::string(kBoth) + "; the dwell time is unknown");
}

// Clamps of the fifth axis on Haas; no control moves an axis by them.
TEST(MachineFunctions, WithTwoMeaningsOfWhichNoneMovesAnAxisBecomeComments) {
  EXPECT_EQ(moves_of("M13\nG0 X1. C2.\nM12\nM2\n", setup_for(Reader::any)),
            moves_of("G0 X1 C2\nM2\n", setup_for(Reader::linuxcnc)));
  const std::vector<std::string> found = warnings_of("M13\nG0 X1. C2.\nM2\n");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[1],
            "p.nc:1:1: error: M13: the brake of the fifth axis (Haas), or the spindle or coolant "
            "on other machines; no axis moves");
}

// G9 stops at the end of its block only.
TEST(ExactStop, OfOneBlockGivesThePathModeBack) {
  const ProgramSetup strict = setup_for(Reader::linuxcnc);
  EXPECT_EQ(moves_of("G64 P0.5\nG9 G1 X1. F100.\nX2.\nM2\n", setup_for(Reader::any)),
            moves_of("G64 P0.5\nG61.1\nG1 X1 F100\nG64 P0.5\nX2\nM2\n", strict));
  EXPECT_EQ(moves_of("G61\nG9 G1 X1. F100.\nX2.\nM2\n", setup_for(Reader::fanuc)),
            moves_of("G61\nG1 X1 F100\nX2\nM2\n", strict));
}

// From (0, -10) up to (0, 0), then along X with the tool of radius 1 on the left: LinuxCNC ends
// the entry at (-1, 0), Fanuc at (0, 1), which is sqrt(2) mm away.
TEST(CutterCompensation, TellsOfAnEntryThatOtherControlsMakeInAnotherWay) {
  const std::string head = "T1 M6\nG0 X0. Y-10.\nG41 D1 G1 X0. Y0. F100.\n";
  std::vector<std::string> found =
      warnings_of(head + "X10.\nG40 Y-10.\nM2\n", setup_for(Reader::any));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0],
            "p.nc:4:1: error: the entry of cutter compensation follows LinuxCNC: the tool ends "
            "line 3 1.4142 mm away from its end point on Fanuc and Haas, which is normal to the "
            "start of the next move (or within two moves: parameter 5003, setting 43); an entry "
            "followed by a move in the same direction is identical on all");
  EXPECT_TRUE(warnings_of(head + "Y10.\nG40 X-10.\nM2\n", setup_for(Reader::any)).empty());
  ProgramSetup strict = setup_for(Reader::linuxcnc);
  Interpreter interpreter(head + "X10.\nG40 Y-10.\nM2\n", "p.nc", strict);
  interpreter.rest();
  EXPECT_TRUE(besides_unit(interpreter.warnings()).empty());
}

TEST(DecimalPoint, IncrementsAreThousandths) {
  const ProgramSetup increments = setup_for(Reader::fanuc, DecimalPoint::increments);
  const ProgramSetup strict = setup_for(Reader::linuxcnc);
  EXPECT_EQ(moves_of("G21 G0 X1000 Y2. A90000\nG4 X1500\nG2 X1. I500 J0 F100\nM2\n", increments),
            moves_of("G21 G0 X1 Y2 A90\nG4 P1.5\nG2 X1 I.5 J0 F100\nM2\n", strict));
  // least input increment 0.0001 inch
  EXPECT_EQ(moves_of("G20 G0 X10000\nM2\n", increments), moves_of("G20 G0 X1\nM2\n", strict));
  const ProgramSetup calculator = setup_for(Reader::fanuc);
  EXPECT_EQ(moves_of("G0 X1000\nG4 X2\nM2\n", calculator),
            moves_of("G0 X1000\nG4 P2\nM2\n", strict));
}

TEST(DecimalPoint, TheFirstLengthWithoutOneIsReported) {
  const std::vector<std::string> found = warnings_of("G0 X0 Y1.\nG0 Z2. X1000\nX5\nM2\n");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0],
            "p.nc:2:8: error: a length without a decimal point: read in millimetres or inches "
            "(LinuxCNC, grbl, Mach); Fanuc and Haas may read increments of 0.001 mm; choose with "
            "--decimal-point or --reader");
  EXPECT_TRUE(warnings_of("G0 X1000. Y0\nM2\n").empty());
  ProgramSetup chosen;
  chosen.decimal_point = DecimalPoint::calculator;
  EXPECT_TRUE(warnings_of("G0 X1000\nM2\n", chosen).empty());
}

TEST(WordDifferences, LeaveADwellUnknownThatIsNotNeeded) {
  ProgramSetup setup = setup_for(Reader::any);
  setup.accepts_unknown_dwells = true;
  Interpreter interpreter("G4 P2\nG0 Z5.\nG99 G82 X1. Z-2. R1. P500 F100.\nG4 P3.\nM2\n", "p.nc",
                          setup);
  std::vector<double> dwells;
  while (const Move* move = interpreter.next()) {
    if (move->kind == MoveKind::dwell) dwells.push_back(move->value);
  }
  ASSERT_EQ(dwells.size(), 3u);
  EXPECT_TRUE(std::isnan(dwells[0]));
  EXPECT_TRUE(std::isnan(dwells[1]));
  EXPECT_EQ(dwells[2], 3.0);
  ASSERT_EQ(besides_unit(interpreter.warnings()).size(), 2u);
  EXPECT_EQ(besides_unit(interpreter.warnings())[0].message,
            both_readings(WordDifference::dwell_unit) + "; the dwell time is unknown");
}

// From the centre to +X, once round, and back; the motion code in force stays.
TEST(CircularPocket, OfMachBeginsAtPlusX) {
  const ProgramSetup setup = setup_for(Reader::mach);
  EXPECT_EQ(moves_of("G0 X10. Y20.\nG12 I4. F300.\nX0.\nM2\n", setup),
            moves_of("G0 X10 Y20\nF300\nG1 X14\nG2 I-4\nG1 X10\nG0 X0\nM2\n",
                     setup_for(Reader::linuxcnc)));
  EXPECT_EQ(moves_of("G91 G13 I4. F300.\nG1 X1.\nM2\n", setup),
            moves_of("G91 F300\nG1 X4\nG3 I-4\nG1 X-4\nX1\nM2\n", setup_for(Reader::linuxcnc)));
  EXPECT_EQ(moves_of("G12 I-4. F300.\nM2\n", setup),
            "p.nc:1:1: error: G12 requires I > 0, G17, and no axis words");
}

}  // namespace
}  // namespace servomill::controllers
