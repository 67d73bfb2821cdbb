/// First stage of reading a program: a line without blanks and comments.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/block.h"

namespace servomill::controllers {

/// Longest line that is accepted, counted in characters without the line end, as LinuxCNC's
/// stand-alone interpreter has it.
inline constexpr std::size_t kLongestLine = 252;

/// A line as the parser wants it: blanks removed (also within numbers, as RS274/NGC has it), upper
/// case, each comment replaced by one '(' so that its place is known.
struct CodeLine {
  std::string text;
  std::vector<int> column;  // of each character of text, plus one behind the last
  std::vector<Comment> comments;

  int column_at(std::size_t i) const { return column[i < column.size() ? i : column.size() - 1]; }
};

/// @param line  one line, without its end
/// @throws InputError for an unclosed or nested comment, a stray ')', a line that is too long, or a
/// character that no program may hold
void read_line(std::string_view line, const std::string& file, int number, CodeLine& out);

}  // namespace servomill::controllers
