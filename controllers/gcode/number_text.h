/// Numbers and comments as programs hold them: numbers in fixed point, without exponents and
/// trailing zeros.
#pragma once

#include <string>
#include <string_view>

namespace servomill::controllers {

/// With so many decimals at most: "10.5", "0".
std::string fixed_text(double x, int decimals);

/// With twelve significant digits at most.
std::string significant_text(double x);

/// "G4 P2.": with a decimal point, without which other controls count milliseconds.
std::string dwell_block(double seconds);

/// Text allowed between '(' and ')': one line of at most 200 characters, brackets in place of
/// parentheses.
std::string comment_text(std::string_view text);

/// A comment with its parentheses that says nothing, whatever the text: one that would read as a
/// message gets a dash before it.
std::string remark(std::string_view text);

}  // namespace servomill::controllers
