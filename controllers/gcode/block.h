/// A block (one line of a program) after parsing: words, assignments, messages and flow control,
/// not yet evaluated. Values are kept as written, in program units.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace servomill::controllers {

/// One step of a compiled expression, run on a stack of numbers.
enum class OpCode : std::uint8_t {
  push,        // `value`
  numbered,    // replaces the index on the stack by the parameter of that number
  named,       // pushes the parameter names[name]
  has_number,  // EXISTS[#...]
  has_name,    // EXISTS[#<...>]
  negate,
  power,
  multiply,
  divide,
  modulo,
  add,
  subtract,
  equal,
  not_equal,
  greater,
  greater_equal,
  less,
  less_equal,
  logical_and,
  logical_or,
  logical_xor,
  abs,
  acos,
  asin,
  atan,  // two operands: ATAN[y]/[x]
  cos,
  exp,
  fix,
  fup,
  ln,
  round,
  sin,
  sqrt,
  tan,
};

struct Op {
  OpCode code = OpCode::push;
  int name = -1;  // index into Block::names
  int column = 0;
  double value = 0.0;
};

/// A value as written: a plain number, or the steps [begin, end) of Block::code.
struct Value {
  double number = 0.0;  // where there are steps: what came out when they were run last
  int begin = 0;
  int end = 0;

  bool is_constant() const { return begin == end; }
};

inline constexpr unsigned kWordLetters = 28;  // A to Z, and those of polar coordinates: @ ^

/// Place of a letter among those of words.
constexpr unsigned word_index(char letter) {
  return letter == '@' ? 26U : letter == '^' ? 27U : static_cast<unsigned>(letter - 'A');
}
constexpr std::uint32_t word_bit(char letter) { return 1U << word_index(letter); }

struct Word {
  char letter = '\0';  // upper case
  Value value;
  int column = 0;
};

/// `#5 = ...` (name < 0, `index` holds the 5) or `#<name> = ...`.
struct Assignment {
  Value index;
  int name = -1;
  Value value;
  int column = 0;
};

enum class CommentKind : std::uint8_t { plain, message, debug, print };

struct Comment {
  CommentKind kind = CommentKind::plain;
  std::string text;  // without the keyword and its comma
  int column = 0;
};

/// Meaning of an O-word, M98 and M99 among them.
enum class Flow : std::uint8_t {
  none,
  sub,
  endsub,
  call,
  return_,
  do_,
  while_,
  endwhile,
  if_,
  elseif,
  else_,
  endif,
  repeat,
  endrepeat,
  break_,
  continue_,
  program,  // O100 alone: where a subprogram of M98 begins
  m98,
  m99,
  unknown,  // only where a program is skipped
};

/// `o100 call [1] [#2]`, `o<name> while [#1 LT 5]`, `M98 P100 L2`.
struct OWord {
  Flow flow = Flow::none;
  int name = -1;  // index into Block::names, or -1: `number` is the label
  Value number;   // also P of M98
  bool has_value = false;
  Value value;  // condition, count, result; L of M98
  std::vector<Value> arguments;
  int column = 0;
  int value_column = 0;
};

enum class PieceKind : std::uint8_t {
  block_delete,
  line_number,
  o_word,  // with what belongs to it
  word,
  assignment,
  comment,
  percent,
  blank,  // only where a line is cut into pieces without gaps
};

/// The bytes [begin, end) of a line. What lies between pieces are blanks.
struct Piece {
  PieceKind kind = PieceKind::word;
  char letter = '\0';  // of a word, upper case
  int begin = 0;
  int end = 0;
};

/// Reused from line to line so that reading a program does not allocate.
struct Block {
  int line = 0;
  bool percent = false;       // the line holds only a %
  bool deleted = false;       // the line starts with / and block delete is on
  OWord o_word;               // flow none: the block has none
  std::vector<Piece> pieces;  // in order; no piece behind the last that was read
  std::vector<Word> words;
  std::vector<Assignment> assignments;
  Comment message;  // the last in brackets: only that one counts; kind plain: none
  std::vector<Op> code;
  std::vector<std::string> names;  // of named parameters: lower case, blanks removed

  void clear() {
    percent = deleted = false;
    o_word.flow = Flow::none;
    pieces.clear();
    words.clear();
    assignments.clear();
    message.kind = CommentKind::plain;
    code.clear();
    names.clear();
  }
};

}  // namespace servomill::controllers
