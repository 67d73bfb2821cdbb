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

/// Returns the sentence that refuses a program written for a SINUMERIK: a main program (*.mpf), a
/// subprogram (*.spf), or a text that begins with its name in the memory of the control,
/// %_N_SHAFT_MPF; else empty. Source: page 43 of the manual that dialects/siemens_reader.h cites;
/// the endings of files are from memory.
std::string siemens_program(ProgramText& text);

/// Returns true for a line that asks grbl or TinyG for a report, which moves nothing; $H and
/// settings do.
bool is_report_request(std::string_view line);

}  // namespace servomill::controllers
