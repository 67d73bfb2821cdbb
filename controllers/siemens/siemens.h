/// Programs for Siemens SINUMERIK 840D: recognised and translated to equivalent lines of G-code.
/// Faults and moves refer to lines of the Siemens program.
#pragma once

#include <set>
#include <span>
#include <string>
#include <string_view>

#include "controllers/gcode/program_setup.h"
#include "controllers/gcode/program_text.h"

namespace servomill::controllers::siemens {

/// Interpretation on which controls or their settings differ; a program that depends on it gets a
/// warning.
struct Reading {
  std::string_view found;     // as written in the program
  std::string_view reading;   // interpretation chosen here
  std::string_view controls;  // those that read it so, or the setting that decides
  std::string_view source;    // manual, or "from memory"
};
std::span<const Reading> readings();

/// Returns true for a file *.mpf or *.spf, a text that begins with its name in the memory of the
/// control (%_N_SHAFT_MPF), and a text with words that only Siemens has, if the reader takes such
/// programs: `any` and `siemens`. The latter takes every text for one.
bool is_siemens(ProgramText& text, Reader reader);

/// Lines of G-code that are equivalent to the program.
/// @param setup  its R parameters, system variables and machine data are removed, since G-code does
///               not have them
ProgramText as_gcode(ProgramText text, ProgramSetup& setup);

/// Returns true for "R5", and for names of system variables and machine data: "$P_TOOLR".
bool is_parameter_name(std::string_view name);

/// Programs that a Siemens program calls, by name without folder and extension.
std::set<std::string> called_programs(ProgramText text);

}  // namespace servomill::controllers::siemens
