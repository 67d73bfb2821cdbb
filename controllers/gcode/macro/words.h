/// Words of macro programs: numbers in place of variables and expressions.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controllers/gcode/macro/expression.h"
#include "controllers/gcode/rewritten_line.h"

namespace servomill::controllers::macro {

struct MacroWord {
  char letter = '\0';  // upper case
  std::size_t begin = 0, end = 0;
  bool is_literal = false, has_point = false;
  int digits = 0;    // of a literal
  MacroValue value;  // vacant: as if it were not written
  bool is_erased = false;

  int column() const { return static_cast<int>(begin) + 1; }
  /// Ten times the number of a code, or -1.
  int tenths() const;
};

/// Units of the words of a block.
struct WordUnits {
  bool is_inch = false;
  bool are_arguments = false;  // of G65 and G66: as they are
};

/// The words from `begin` on.
/// @param body     the line, with blanks in place of comments
/// @param context  its increment does not count
std::vector<MacroWord> read_words(std::string_view body, std::size_t begin,
                                  const Expression::Context& context, const WordUnits& units);

/// A line with numbers in place of expressions, and where its characters come from.
class ExpandedLine {
 public:
  /// @param text  as written
  void set(std::string_view text);
  /// @throws InputError for a P that two controls read differently
  void set(std::string_view text, const std::vector<MacroWord>& words,
           const Expression::Context& context, const WordUnits& units);
  const std::string& text() const { return line_.text(); }
  bool has_words() const { return has_words_; }
  int original_column(int column) const { return line_.original_column(column); }

 private:
  RewrittenLine line_;
  bool has_words_ = false;
};

/// Least input increment of the word of a letter, mm, inch or degrees; 0: none.
/// Source: Fanuc, increment system IS-B; Haas 96-8000, June 1999, p. 374 (three places, four in
/// inches).
double increment_of(char letter, bool is_inch);

}  // namespace servomill::controllers::macro
