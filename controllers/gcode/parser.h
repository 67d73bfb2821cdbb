/// Second stage of reading a program: from a line to a block.
#pragma once

#include <string>
#include <string_view>

#include "controllers/gcode/block.h"
#include "controllers/gcode/lexer.h"

namespace servomill::controllers {

/// Reads the lines of programs.
/// Grammar (blanks and case do not count):
///   line  = ["/"] ["N" digits ["." digits]] (oword | {comment | "#" param "=" value | letter
///   value})
///         | "%"
///   oword = "O" label ["SUB" | "DO" | "ELSE" | "ENDIF" | "ENDWHILE" | "ENDREPEAT" | "BREAK" |
///           "CONTINUE" | ("ENDSUB" | "RETURN") ["[" expr "]"] | "CALL" {"[" expr "]"} |
///           ("IF" | "ELSEIF" | "WHILE" | "REPEAT") "[" expr "]"] {comment}
///         | "M98" {"P" value | "L" value | any other word} | "M99" {comment}
///   label = "<" name ">" | value
///   value = number | "[" expr "]" | "#" param | ("+"|"-") value | function "[" expr "]"
///         | "ATAN[" expr "]/[" expr "]"
///   param = value | "<" name ">"
///   expr  = value {operator value}; operators bind, tightest first: ** | * / MOD | + -
///           | EQ NE GT GE LT LE | AND OR XOR; all of them from left to right
class Parser {
 public:
  explicit Parser(bool block_delete = false) : block_delete_(block_delete) {}

  /// Makes blocks keep their pieces. They do not at first: to run a program no one needs them.
  void keep_pieces(bool keep) { keeps_pieces_ = keep; }

  /// How much of a line is read. Where flow control skips, RS274/NGC does not look at what a line
  /// says, only at its comments, and at the label and the keyword of its O-word; and where a line
  /// ends the skipping, not behind its O-word.
  enum class Extent { all, flow_only, flow_value };

  /// @param line  without its end
  /// @param block cleared and filled. Its pieces tell of the whole line: behind the last one, and
  /// between them, there are blanks only
  /// @throws InputError with file:line:column
  void parse(std::string_view line, const std::string& file, int number, Block& block,
             Extent extent = Extent::all);

 private:
  [[noreturn]] void fail(std::size_t at, std::string message) const;
  [[noreturn]] void fail_here(std::string message) const { fail(cursor_.at(), std::move(message)); }
  char peek() const { return cursor_.peek(); }
  bool accept(std::string_view token) { return cursor_.accept(token); }
  int column() const { return cursor_.column(); }
  void emit(OpCode code, int column, double value = 0.0, int name = -1);
  void add_piece(PieceKind kind, std::size_t begin, char letter = '\0');

  void item();
  void word();
  void assignment();
  void line_number();
  void skip_digits();
  void comment();
  void flow(Extent extent);
  void label(OWord& o);
  void value_of_flow(OWord& o, std::string_view keyword);
  void arguments(OWord& o, std::size_t start);
  [[noreturn]] void fail_at_keyword();
  void subprogram_call(OWord& o);
  void only_comments(std::string_view keyword);
  Value bracketed_value(std::string_view what);
  Value value(std::string_view what);
  void real(std::string_view what);
  double number(std::string_view what);
  void parameter(OpCode numbered, OpCode named);
  int name_in_angles(std::string_view what);
  void function(std::string_view what);
  void bracketed();
  void expression(int loosest);

  bool block_delete_;
  bool keeps_pieces_ = false;
  Cursor cursor_;
  const std::string* file_ = nullptr;
  int number_ = 0;
  std::uint32_t letters_ = 0;  // of the words so far but G and M, a bit each
  Block* block_ = nullptr;
};

/// The line as it was read, from its pieces and the blanks between them: the law that nothing of
/// it is lost.
std::string print_line(std::string_view line, const Block& block);

}  // namespace servomill::controllers
