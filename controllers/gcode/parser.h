/// Second stage of reading a program: from a line to a block.
#pragma once

#include <string>
#include <string_view>

#include "controllers/gcode/block.h"
#include "controllers/gcode/lexer.h"

namespace servomill::controllers {

/// Reads the lines of one program.
/// Grammar (blanks removed, upper case):
///   line  = ["/"] ["N" digits ["." digits]] {comment | "#" param "=" value | letter value} | "%"
///   value = number | "[" expr "]" | "#" param | ("+"|"-") value | function "[" expr "]"
///         | "ATAN[" expr "]/[" expr "]"
///   param = value | "<" name ">"
///   expr  = value {operator value}; operators bind, tightest first: ** | * / MOD | + -
///           | EQ NE GT GE LT LE | AND OR XOR; all of them from left to right
class Parser {
 public:
  explicit Parser(std::string file, bool block_delete = false)
      : file_(std::move(file)), block_delete_(block_delete) {}

  /// @param line  without its end
  /// @param block cleared and filled
  /// @throws InputError with file:line:column
  void parse(std::string_view line, int number, Block& block);

 private:
  [[noreturn]] void fail(std::size_t at, std::string message) const;
  [[noreturn]] void fail_here(std::string message) const { fail(at_, std::move(message)); }
  char peek() const { return at_ < line_.text.size() ? line_.text[at_] : '\0'; }
  bool accept(std::string_view token);
  int column() const { return line_.column_at(at_); }
  void emit(OpCode code, int column, double value = 0.0, int name = -1);

  void item();
  void word();
  void assignment();
  void line_number();
  void skip_digits();
  void take_comment();
  Value value(std::string_view what);
  void real(std::string_view what);
  double number(std::string_view what);
  void parameter(OpCode numbered, OpCode named);
  int parameter_name();
  void function();
  void bracketed();
  void expression(int loosest);

  std::string file_;
  bool block_delete_;
  CodeLine line_;
  int number_ = 0;
  std::size_t at_ = 0;
  std::size_t comments_taken_ = 0;
  Block* block_ = nullptr;
};

}  // namespace servomill::controllers
