/// Programs in custom macro B of Fanuc and Haas: recognised, and run to the blocks in G-code that
/// the control would have executed. Faults and moves refer to lines of the program as written.
#pragma once

#include <memory>
#include <set>
#include <string>

#include "controllers/gcode/macro/control_state.h"
#include "controllers/gcode/program_setup.h"
#include "controllers/gcode/program_text.h"

namespace servomill::controllers::macro {

/// The first line that only custom macro B has: IF[, WHILE[, GOTO, G65 P, G66 P; 0: none. A program
/// with O-words of LinuxCNC has none.
int first_macro_line(ProgramText& text);

/// Returns true for a text that the reader runs as a macro: `any` one with such a line; `fanuc` and
/// `haas` every one that uses variables or expressions.
bool is_macro_program(ProgramText& text, Reader reader);

/// Blocks in G-code, one by one, as the program runs.
/// @param control  asked for system variables when a line reads them
ProgramText as_gcode(ProgramText text, ProgramSetup& setup,
                     std::shared_ptr<const ControlState> control);

/// Numbers of programs that lines call with M98, G65 and G66, where they are literal.
std::set<std::string> called_programs(ProgramText text);

}  // namespace servomill::controllers::macro
