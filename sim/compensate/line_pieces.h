/// The pieces of a program line, so that some can be changed and the others stay as they are.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace servomill::sim {

enum class PieceKind : std::uint8_t {
  blank,
  block_delete,  // '/'
  line_number,   // N10
  o_word,        // O100 and all that follows it
  word,          // X10.5, G1, M3
  assignment,    // #5=3
  comment,       // ( ... ) or from ';' on
  percent,
};

/// [begin, end) of the line's text.
struct LinePiece {
  PieceKind kind = PieceKind::blank;
  std::size_t begin = 0, end = 0;
  char letter = '\0';       // of a word, upper case
  bool is_constant = true;  // no expression
  std::string_view of(std::string_view line) const { return line.substr(begin, end - begin); }
};

/// Pieces that tile the line.
/// @pre the interpreter has taken the line
std::vector<LinePiece> line_pieces(std::string_view line);

}  // namespace servomill::sim
