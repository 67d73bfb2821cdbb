/// Heidenhain conversational programs: recognised and translated to equivalent lines of G-code.
/// Faults and moves refer to lines of the conversational program.
#pragma once

#include <set>
#include <span>
#include <string>
#include <string_view>

#include "controllers/gcode/program_setup.h"
#include "controllers/gcode/program_text.h"

namespace servomill::controllers::conversational {

/// Interpretation on which controls differ; a program that depends on it gets a warning.
struct Reading {
  std::string_view found;     // as written in the program
  std::string_view reading;   // interpretation chosen here
  std::string_view controls;  // interpretation by other controls
  std::string_view source;    // manual, or "from memory"
};
std::span<const Reading> readings();

/// Returns true for a text that begins with BEGIN PGM, and for a file called *.h or *.H, if the
/// reader takes such programs: `any` and `heidenhain`. The latter takes every text for one.
bool is_conversational(ProgramText& text, Reader reader);

/// Lines of G-code that are equivalent to the program.
/// @param setup  receives the tools that the program defines; its Q parameters are removed, since
///               G-code does not have them
ProgramText as_gcode(ProgramText text, ProgramSetup& setup);

/// The setup for running G-code that was written from a program: `setup` itself, unless that
/// program is conversational.
ProgramSetup gcode_setup(ProgramText text, ProgramSetup setup);

/// Returns true for "Q5", "QL2", "QR7".
bool is_parameter_name(std::string_view name);

/// Programs that a conversational program calls, by name without folder and extension.
std::set<std::string> called_programs(ProgramText text);

}  // namespace servomill::controllers::conversational
