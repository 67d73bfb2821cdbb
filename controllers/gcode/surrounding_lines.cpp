// Looks at a line that was read, and at those behind it.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/interpreter_machine.h"
#include "controllers/gcode/modal_groups.h"

namespace servomill::controllers {

// The corner of the line just read, and the block behind it.
CornerToNext Interpreter::Machine::corner_to_next() {
  const CornerWord& word = *reader_.corner();
  CornerToNext out;
  out.size.letter = word.letter;
  out.size.value = word.value;
  out.size.column = word.column;
  out.size.has_point = word.has_point;
  out.size.is_literal = true;
  out.is_next = false;
  if (text().is_generated()) return out;
  const ProgramText::Mark here = text().mark();
  LineReader reader(setup_.block_delete, setup_.reader);
  reader.keep_pieces(true);
  for (std::string_view line; text().next(line);) {
    if (is_blank(line)) continue;
    out.next.clear();
    reader.parse(line, file(), text().number(), out.next);
    if (out.next.deleted || (out.next.words.empty() && out.next.assignments.empty())) continue;
    out.next_line = line;
    out.is_next = out.next.o_word.flow == Flow::none && out.next.assignments.empty() &&
                  std::all_of(out.next.words.begin(), out.next.words.end(),
                              [](const Word& one) { return one.value.is_constant(); });
    break;
  }
  text().go_to(here);
  return out;
}

// K of a canned cycle counts, but for that of back boring.
bool Interpreter::Machine::is_counted_by_K() const {
  constexpr int kBackBoring = 870;
  int motion = state_.motion;
  for (const Word& word : block_.words) {
    if (word.letter != 'G' || !word.value.is_constant()) continue;
    const int tenths = static_cast<int>(std::lround(10.0 * word.value.number));
    const Code* code = find_code('G', tenths);
    if (code != nullptr && code->group == Group::g_motion) motion = tenths;
  }
  return is_canned_cycle(motion) && motion != kBackBoring;
}

// X10: 10 mm, or 10 increments.
void Interpreter::Machine::look_for_missing_points() {
  constexpr std::string_view kLengths = "XYZIJKR";
  std::size_t nth = 0;
  for (const Piece& piece : block_.pieces) {
    if (piece.kind != PieceKind::word) continue;
    const Word& word = block_.words[nth++];
    if (kLengths.find(word.letter) == std::string_view::npos) continue;
    if (word.letter == 'K' && is_counted_by_K()) continue;
    if (!word.value.is_constant() || word.value.number == 0.0) continue;
    const auto begin = static_cast<std::size_t>(piece.begin);
    const std::string_view written =
        line_.substr(begin, static_cast<std::size_t>(piece.end) - begin);
    if (written.find('.') != written.npos) continue;
    warn(word.column,
         "a length without a decimal point: read in millimetres or inches (LinuxCNC, grbl, Mach); "
         "Fanuc and Haas may read increments of 0.001 mm; choose with --decimal-point or --reader");
    has_warned_of_points_ = true;
    return;
  }
}

}  // namespace servomill::controllers
