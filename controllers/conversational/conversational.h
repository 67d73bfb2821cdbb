/// Heidenhain conversational programs for whoever runs G-code: recognised, and handed out as lines
/// in G-code that mean the same. Places of faults and moves are those of the conversational
/// program.
#pragma once

#include <set>
#include <span>
#include <string>
#include <string_view>

#include "controllers/gcode/program_setup.h"
#include "controllers/gcode/program_text.h"

namespace servomill::controllers::conversational {

/// A reading that is warned of where a program needs it.
struct Reading {
  std::string_view found;     // in the program
  std::string_view reading;   // how it is read
  std::string_view controls;  // and how else
  std::string_view source;    // manual, or "from memory"
};
std::span<const Reading> readings();

/// Returns true for a text that begins with BEGIN PGM, and for a file called *.h or *.H, if the
/// reader takes such programs: `any` and `heidenhain`. The latter takes every text for one.
bool is_conversational(ProgramText& text, Reader reader);

/// The lines in G-code.
/// @param setup  receives the tools that the program defines; loses its Q parameters, which are no
///               parameters of G-code
ProgramText as_gcode(ProgramText text, ProgramSetup& setup);

/// The setup in which G-code runs that was written from a program: itself, unless that program is
/// conversational.
ProgramSetup gcode_setup(ProgramText text, ProgramSetup setup);

/// Returns true for "Q5", "QL2", "QR7".
bool is_parameter_name(std::string_view name);

/// The programs that it calls, by name without folder and extension.
std::set<std::string> called_programs(ProgramText text);

}  // namespace servomill::controllers::conversational
