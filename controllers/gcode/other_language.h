/// Lines that are no G-code, by the words that give them away.
#pragma once

#include <string>
#include <string_view>

#include "controllers/gcode/program_text.h"

namespace servomill::controllers {

/// The sentence that names the language of a line, if it is none of G-code: Heidenhain's
/// conversational, words of Siemens, macros of Fanuc, words of a printer; else empty.
/// @param column  of the character that is no G-code, from 1; 0: unknown
std::string other_language(std::string_view line, int column);

/// Returns the sentence that refuses a whole program in DIN/ISO of Heidenhain (%PART G71), else
/// empty. The first line of DIN/ISO is from memory.
std::string refused_program(ProgramText& text);

/// Column of the words behind a ';' that follows a block, "G0 X1.; Y2.", from 1; 0 if there are
/// none, or if what stands there is a text.
int column_of_second_block(std::string_view line);

/// Returns true for a line that asks grbl or TinyG for a report, which moves nothing; $H and
/// settings do.
bool is_report_request(std::string_view line);

}  // namespace servomill::controllers
