/// Characters of a line, for the sources of the parser.
#pragma once

#include <string>

#include "controllers/gcode/lexer.h"

namespace servomill::controllers {

/// @param c  as Cursor::peek gives it, in upper case
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
inline bool is_letter(char c) { return c >= 'A' && c <= 'Z'; }

/// The run of letters where the cursor stands; it is left behind them.
std::string take_letters(Cursor& cursor);

/// The character as messages name it.
std::string shown(char c);

}  // namespace servomill::controllers
