/// Characters of a Siemens block: names, numbers and texts, one after the other.
#pragma once

#include <string>
#include <string_view>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::siemens {

/// A letter, a digit or '_'.
bool is_name_character(char c);
bool is_digit(char c);
bool is_letter(char c);
/// The text in capitals: the language does not distinguish case (840D sl, Fundamentals, "Structure
/// of an NC program").
std::string capitals(std::string_view text);

/// Hands out the parts of a block; its comment is dropped.
class Scanner {
 public:
  /// @param line    stays valid as long as the scanner
  /// @param column  of its first character in the line of the program, from 0
  Scanner(std::string_view line, const std::string& file, int number, std::size_t column = 0);

  /// The place of the next character.
  Place place() const;
  Place place(std::size_t at) const;
  [[noreturn]] void fail(std::string message) const;

  bool at_end();  // behind blanks
  /// The next character, '\0' at the end; blanks are not skipped.
  char now() const { return at_ < line_.size() ? line_[at_] : '\0'; }
  char ahead(std::size_t by) const { return at_ + by < line_.size() ? line_[at_ + by] : '\0'; }
  void skip_blanks();
  std::size_t position() const { return at_; }
  void go_to(std::size_t position) { at_ = position; }
  std::string_view from(std::size_t begin) const { return line_.substr(begin, at_ - begin); }
  std::string_view rest() const { return line_.substr(at_); }

  /// Skips blanks and takes this character, if it comes next.
  bool take(char c);
  /// Skips blanks and takes this operator, if it comes next.
  bool take_sign(std::string_view sign);
  /// Skips blanks and takes the name (in capitals), if it comes next as a whole word.
  bool take_word(std::string_view name);
  /// The name that comes next (in capitals), without taking it; empty: none does.
  std::string peek_name();
  std::string read_name();
  /// @throws InputError unless it comes next
  void expect(char c, std::string_view behind);
  /// "12.5", "1.5EX-3", 'HFF', 'B101': without a sign.
  double read_number();
  bool is_at_number();
  /// Text in double quotes.
  std::string read_text();
  /// "[1,X,TR]" if it comes next, in capitals and without blanks; else empty.
  std::string read_brackets();
  /// Text up to the parenthesis that closes one that was taken before, which is taken, too.
  std::string_view read_to_parenthesis();

 private:
  double read_constant();

  std::string_view line_;
  const std::string& file_;
  int number_;
  std::size_t column_;
  std::size_t at_ = 0;
};

}  // namespace servomill::controllers::siemens
