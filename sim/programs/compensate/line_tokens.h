/// The pieces of a program line, blanks among them, so that some can be changed and the others stay
/// as they are.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "controllers/gcode/interpreter.h"

namespace servomill::sim::programs {

using controllers::PieceKind;

/// [begin, end) of the line's text.
struct LineToken {
  PieceKind kind = PieceKind::blank;
  std::size_t begin = 0, end = 0;
  char letter = '\0';       // of a word, upper case
  bool is_constant = true;  // its value is no expression
  std::string_view of(std::string_view line) const { return line.substr(begin, end - begin); }
};

/// True if the operator's switch decides about the block.
bool has_slash(const controllers::ExecutedBlock& executed);

/// Pieces that tile the line of a block; none of one that O-words skip.
std::vector<LineToken> line_tokens(const controllers::ExecutedBlock& block);

}  // namespace servomill::sim::programs
