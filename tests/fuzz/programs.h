/// How the targets of G-code run a program.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/interpreter.h"

namespace servomill::fuzz {

inline constexpr std::string_view kProgram = "p.ngc";

/// A program is not run further after so many moves or, where these are counted, lines: a loop may
/// give them without end.
inline constexpr std::size_t kMaxMoves = 20'000, kMaxLines = 20'000;

/// Tools 1 and 3, a few parameters, offsets and a start off the origin, the subroutine files `side`
/// and `100`, few jumps. Lines with '/' count or do not, there is a five-axis machine or there is
/// none, as the length of the program is: so that the text alone decides, and a small change of it
/// gets to either.
controllers::ProgramSetup setup_for(std::string_view program);

/// Law: a fault has its place in the program or in one of the subroutine files.
void require_program_places(std::span<const Fault> faults, std::string_view program);

/// Moves of a program until its end, its first fault or too many moves.
std::vector<Move> moves_until_fault(std::string_view program,
                                    const controllers::ProgramSetup& setup);

}  // namespace servomill::fuzz
