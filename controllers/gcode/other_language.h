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

/// Returns the sentence that refuses a whole program in another language: DIN/ISO of Heidenhain
/// (%PART G71), or one written for a SINUMERIK: a main program (*.mpf), a subprogram (*.spf), or a
/// text that begins with its name in the memory of the control, %_N_SHAFT_MPF; else empty. Source:
/// page 43 of the manual that dialects/siemens_reader.h cites; the endings of files and the first
/// line of DIN/ISO are from memory.
/// @param is_control_chosen  by the user, who may so read what is only called as Siemens's are
std::string refused_program(ProgramText& text, bool is_control_chosen);

/// Column of the words behind a ';' that follows a block, "G0 X1.; Y2.", from 1; 0 if there are
/// none, or if what stands there is a text.
int column_of_second_block(std::string_view line);

/// Returns true for a line that asks grbl or TinyG for a report, which moves nothing; $H and
/// settings do.
bool is_report_request(std::string_view line);

}  // namespace servomill::controllers
