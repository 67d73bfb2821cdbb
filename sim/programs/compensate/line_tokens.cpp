#include "sim/programs/compensate/line_tokens.h"

#include <algorithm>

namespace servomill::sim::programs {

bool has_slash(const controllers::ExecutedBlock& executed) {
  return executed.block != nullptr &&
         std::any_of(
             executed.block->pieces.begin(), executed.block->pieces.end(),
             [](const controllers::Piece& piece) { return piece.kind == PieceKind::block_delete; });
}

std::vector<LineToken> line_tokens(const controllers::ExecutedBlock& executed) {
  std::vector<LineToken> out;
  if (executed.block == nullptr) return out;
  const controllers::Block& block = *executed.block;
  std::size_t at = 0, words = 0, assignments = 0;
  const auto blanks_until = [&](std::size_t end) {
    if (end > at) out.push_back({PieceKind::blank, at, end});
    at = end;
  };
  for (const controllers::Piece& piece : block.pieces) {
    blanks_until(static_cast<std::size_t>(piece.begin));
    LineToken one{piece.kind, at, static_cast<std::size_t>(piece.end), piece.letter};
    if (piece.kind == PieceKind::word) one.is_constant = block.words[words++].value.is_constant();
    if (piece.kind == PieceKind::assignment) {
      one.is_constant = block.assignments[assignments++].value.is_constant();
    }
    out.push_back(one);
    at = one.end;
  }
  blanks_until(executed.text.size());
  return out;
}

}  // namespace servomill::sim::programs
