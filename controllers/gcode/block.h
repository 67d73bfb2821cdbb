/// A block (one line of a program) after parsing: words, assignments and messages, not yet
/// evaluated. Values are kept as written, in program units.
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
  double number = 0.0;
  int begin = 0;
  int end = 0;

  bool is_constant() const { return begin == end; }
};

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

/// Reused from line to line so that reading a program does not allocate.
struct Block {
  int line = 0;
  bool percent = false;  // the line holds only a %
  bool deleted = false;  // the line starts with / and block delete is on
  std::vector<Word> words;
  std::vector<Assignment> assignments;
  std::vector<Comment> messages;  // in order; plain comments are dropped
  std::vector<Op> code;
  std::vector<std::string> names;  // of named parameters: lower case, blanks removed

  void clear() {
    percent = deleted = false;
    words.clear();
    assignments.clear();
    messages.clear();
    code.clear();
    names.clear();
  }
};

}  // namespace servomill::controllers
