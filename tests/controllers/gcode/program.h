/// Short ways to run programs in tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

inline constexpr double kExact = 1e-15;  // m, rad, m/s: a few roundings at magnitudes below 1

/// Tools 1 (100 mm long) and 3 (offset in X, Y and Z).
inline ProgramSetup usual_setup() {
  ProgramSetup setup;
  setup.tools = ToolTable::parse("T1 P1 Z100 D8\nT3 P3 X0.5 Y-0.25 Z33 D10\n", "tools.tbl");
  return setup;
}

/// All moves but the closing `end` of `text`, to which M2 is added.
inline std::vector<Move> moves_of(const std::string& text,
                                  const ProgramSetup& setup = usual_setup()) {
  std::vector<Move> moves = interpret(text + "\nM2\n", "p.nc", setup);
  EXPECT_EQ(moves.back().kind, MoveKind::end);
  moves.pop_back();
  return moves;
}

inline Move last_move(const std::string& text, const ProgramSetup& setup = usual_setup()) {
  const std::vector<Move> moves = moves_of(text, setup);
  EXPECT_FALSE(moves.empty()) << text;
  return moves.empty() ? Move{} : moves.back();
}

/// The message of the fault of `text` (M2 added), or "" if there is none.
inline std::string fault_of(const std::string& text, const ProgramSetup& setup = usual_setup()) {
  try {
    interpret(text + "\nM2\n", "p.nc", setup);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

/// mm and degrees.
inline AxisWords axes(double x, double y, double z, double a = 0, double b = 0, double c = 0) {
  AxisWords words;
  words << x * mm, y * mm, z * mm, a * deg, b * deg, c * deg;
  return words;
}

inline void expect_axes(const AxisWords& found, const AxisWords& wanted) {
  EXPECT_LE((found - wanted).cwiseAbs().maxCoeff(), 10 * kExact)
      << "found " << found.transpose() << "\nwanted " << wanted.transpose();
}

}  // namespace servomill::controllers
