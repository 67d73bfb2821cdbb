/// How the targets of G-code run a program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/interpreter.h"

namespace servomill::fuzz {

inline constexpr std::string_view kProgram = "p.ngc";

/// After so many moves a program is not run further: they may come without end.
inline constexpr std::size_t kMostMoves = 20'000;

/// Tools 1 and 3, a few parameters, offsets and a start off the origin; lines with '/' count or do
/// not, there is a five-axis machine or there is none, as the length of the program is: so that the
/// text alone decides, and a small change of it gets to either.
controllers::ProgramSetup setup_for(std::string_view program);

/// What a program gives until its end, its first fault or too many moves.
struct Outcome {
  std::vector<Move> moves;
  bool has_fault = false;
};
Outcome moves_until_fault(std::string_view program, const controllers::ProgramSetup& setup);

}  // namespace servomill::fuzz
