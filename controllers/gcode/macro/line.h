/// Lines of macro programs: their statements, without comments, block numbers and block skips.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace servomill::controllers::macro {

enum class Statement : std::uint8_t {
  blank,               // nothing, or comments only
  percent,             // %
  program_number,      // O1000, :1000
  assignment,          // #1=...
  if_,                 // IF[...]GOTO10, IF[...]THEN #1=...
  while_,              // WHILE[...]DO1
  do_,                 // DO1
  end,                 // END1
  go_to,               // GOTO10
  conditional_return,  // [...] M99 of Haas
  output,              // POPEN, PCLOS, DPRNT[...], BPRNT[...]
  words                // G, M, X, ... : all others, calls among them
};

struct Line {
  Statement statement = Statement::blank;
  std::string body;          // the line, with blanks in place of all that is no statement
  std::size_t begin = 0;     // of the statement in the body
  long block_number = -1;    // N
  bool is_optional = false;  // begins with '/'
  std::string comment;       // the first
};

/// @param line  set; reused from line to line
void read_line(std::string_view text, Line& line);

/// The statement that begins there.
Statement statement_at(std::string_view body, std::size_t at);

/// True for a line that only custom macro B has: it begins with IF[, WHILE[, GOTO 10, G65, G66,
/// M99 P, POPEN and the like, or assigns #1=#2+1 without brackets.
bool is_macro_only(std::string_view text, Line& line);

/// True if words hold M97, M98, M99, G65, G66 or G67.
bool has_call_code(std::string_view body);

}  // namespace servomill::controllers::macro
