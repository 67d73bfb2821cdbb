/// Expressions of custom macro B, read and evaluated in one go.
#pragma once

#include <string>
#include <string_view>

#include "controllers/gcode/lexer.h"
#include "controllers/gcode/macro/variables.h"

namespace servomill::controllers::macro {

/// Grammar (blanks and case do not count):
///   operand    = number | "#" (digits | "[" expression "]") | function | "[" expression "]"
///              | ("+"|"-") operand
///   function   = name "[" expression "]" | ATAN "[" y "]" ["/" "[" x "]"] | POW "[" a "," b "]"
///   expression = operand {operator operand}; operators bind, tightest first: * / AND MOD
///              | + - OR XOR | EQ NE GT GE LT LE; all of them from left to right
/// AND, OR and XOR work on the bits of whole numbers; a comparison is 1 or 0.
/// Source: Fanuc B-63684EN/01, chapter 16 (order of operations, from memory); Haas 96-8000, June
/// 1999, p. 374 to 376; NCT 99M, 2000M programmer's manual, 20.13.2 p. 185 (OR and XOR are
/// additive, AND is multiplicative; each works on the bits of 32-bit numbers). MOD:
/// differences.cpp.
class Expression {
 public:
  struct Context {
    const Variables& variables;
    MacroReading& reading;
    const std::string& file;
    int line = 0;
    double increment = 0.0;  // that ROUND rounds to, in the word of an address; 0: whole numbers
  };

  /// @param line  blanks in place of its comments
  Expression(std::string_view line, std::size_t at, const Context& context)
      : context_(context), cursor_(line) {
    cursor_.go_to(at);
    if (cursor_.peek() == ' ' || cursor_.peek() == '\t') cursor_.advance();
  }

  /// The value of a word: an operand without operators around it.
  MacroValue word_value();
  /// The right side of an assignment: an expression, in brackets or not.
  MacroValue assigned_value();
  /// A condition in brackets.
  bool condition();
  /// The number of a variable, behind its '#'.
  long variable_number();
  Cursor& cursor() { return cursor_; }

 private:
  // `is_doubtful`: vacant, but behind a sign or in brackets, where no manual says what it is
  struct Term {
    MacroValue value;
    bool is_doubtful = false, is_comparison = false;
    int column = 0;
    double number() const { return value.value_or(0.0); }
  };
  struct Seen {
    bool comparison = false, logic = false, arithmetic = false;
  };

  Place here(int column) const { return {context_.file, context_.line, column}; }
  [[noreturn]] void refuse(int column, std::string message) const {
    context_.reading.refuse(here(column), std::move(message));
  }
  Term expression(int loosest, Seen& seen);
  Term expression();
  Term operand();
  Term operand_within();
  Term signed_operand(bool is_minus);
  Term bracketed();
  Term function();
  double argument();
  double atan(int column);
  double pow(int column);
  Term combine(int op, const Term& a, const Term& b, int column);
  double compare(int op, const Term& a, const Term& b, int column);
  double logic(int op, const Term& a, const Term& b, int column) const;
  double remainder(double a, double b, int column) const;
  double angle(double degrees, int column) const;
  double rounded(double x) const;
  double decimal(bool is_to_binary, double x, int column) const;
  double in_range(double x, std::string_view name, int column) const;
  MacroValue settled(const Term& term) const;

  const Context context_;
  Cursor cursor_;
  int depth_ = 0;  // of brackets and signs
};

/// A number as the control has it: rounded to the increment, halves away from zero.
double rounded_to(double x, double increment);

}  // namespace servomill::controllers::macro
