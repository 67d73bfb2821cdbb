// Words that two controls read differently: none is read in silence. Each difference has a program;
// the reader `any` refuses it with both readings, a reader that has one of them reads it so.
#include "controllers/gcode/readers/differences.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

std::string moves_of(const std::string& text, ProgramSetup setup) {
  std::string out;
  try {
    Interpreter interpreter(text, "p.nc", std::move(setup));
    while (const Move* move = interpreter.next()) out += canon_json(*move) + "\n";
  } catch (const InputError& error) {
    return error.what();
  }
  for (std::size_t at; (at = out.find("\"line\":")) != std::string::npos;) {
    out.erase(at, out.find_first_of(",}", at) - at);
  }
  return out;
}

ProgramSetup setup_for(Reader reader, DecimalPoint decimal_point = DecimalPoint::calculator) {
  ProgramSetup setup;
  setup.reader = reader;
  const bool depends = reader == Reader::fanuc || reader == Reader::haas;
  if (depends) setup.decimal_point = decimal_point;
  setup.tools = ToolTable::parse("T1 P1 Z10 D2\nT2 P2 Z20 D4\n", "tools.tbl");
  return setup;
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
      {override_codes, "M50 P0\nG0 X1.\nM2\n", "p.nc:1:1", {}},
      {start_motion, "X1.\nM2\n", "p.nc:1:1", {"G0 X1\nM2\n", ""}},
      {decimal_point, "G0 X1000\nM2\n", "p.nc:1:4", {}},
      {scale_factor, "G51 P2\nG0 X1.\nM2\n", "p.nc:1:5", {"G0 X2\nM2\n", "G0 X0.002\nM2\n"}},
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
    SCOPED_TRACE(one.program);
    // lengths are in millimetres unless a control that counts increments is chosen
    const bool is_of_fanuc = one.difference == WordDifference::decimal_point;
    const Reader reader = is_of_fanuc ? Reader::fanuc : Reader::any;
    EXPECT_EQ(moves_of(one.program, setup_for(reader, DecimalPoint::unset)),
              one.place + ": error: " + both_readings(one.difference));
  }
}

TEST(WordDifferences, AReaderHasOneOfThem) {
  for (const Example& one : examples()) {
    for (const Reader reader : {Reader::fanuc, Reader::haas, Reader::mach, Reader::grbl}) {
      if (one.difference == WordDifference::decimal_point ||
          one.difference == WordDifference::dwell_increments ||
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

TEST(WordDifferences, OverridesAreNoFunctionsOfOtherControls) {
  for (const Reader reader : {Reader::fanuc, Reader::haas, Reader::mach, Reader::grbl}) {
    EXPECT_NE(moves_of("M50 P0\nG0 X1.\nM2\n", setup_for(reader)).find(": error: "),
              std::string::npos);
  }
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

TEST(DecimalPoint, AProgramWithoutAnyIsReported) {
  ProgramSetup setup;
  setup.reader = Reader::any;
  Interpreter interpreter("G0 X0\nG0 X1000\nM2\n", "p.nc", setup);
  interpreter.rest();
  ASSERT_EQ(interpreter.warnings().size(), 1u);
  EXPECT_EQ(to_string(interpreter.warnings()[0]),
            "p.nc:2:4: error: no length of the program has a decimal point: read in millimetres, "
            "inches or degrees (LinuxCNC, grbl, Mach); Fanuc and Haas may read increments of 0.001 "
            "mm; choose with --decimal-point or --reader");
  Interpreter other("G0 X1000\nG0 X1.\nM2\n", "p.nc", setup);
  other.rest();
  EXPECT_TRUE(other.warnings().empty());
}

}  // namespace
}  // namespace servomill::controllers
