// M97: a subprogram that begins at a block number; and the height of a tool of unknown length.
#include <fmt/format.h>

#include <cctype>
#include <string_view>

#include "controllers/gcode/interpreter_machine.h"

namespace servomill::controllers {
namespace {

// The number N of a line, or -1.
long block_number(std::string_view line) {
  std::size_t at = line.find_first_not_of(" \t/");
  if (at == std::string_view::npos || (line[at] != 'N' && line[at] != 'n')) return -1;
  long number = -1;
  constexpr long kMax = 99'999'999;
  for (++at; at < line.size() && line[at] >= '0' && line[at] <= '9' && number <= kMax; ++at) {
    number = std::max(number, 0L) * 10 + (line[at] - '0');
  }
  return number;
}

}  // namespace

std::optional<LinePlace> Interpreter::Machine::place_of_block(int number) {
  const ProgramText::Mark here = text().mark();
  std::optional<LinePlace> found;
  text().rewind();
  for (std::string_view next; !found;) {
    const LinePlace place{text_, text().mark()};
    if (!text().next(next)) break;
    if (block_number(next) == number) found = place;
  }
  text().go_to(here);
  return found;
}

// With L the block that calls runs again and again, as that of M98.
void Interpreter::Machine::call_block(const LocalCall& call) {
  const auto place = place_of_block(call.block_number);
  if (!place) {
    fail(call.column, fmt::format("M97 P{0}: block N{0} not found", call.block_number));
  }
  long& turns = flow_.turns_left.back();
  if (turns == 0) turns = call.repeats;
  const bool again = --turns > 0;
  OWord o;
  o.flow = Flow::m98;
  o.column = call.column;
  enter_call(fmt::format("N{}", call.block_number), o,
             again ? here_ : LinePlace{text_, text().mark()});
  go_to(*place);
}

// A move that names Z in work coordinates ends at a known height.
void Interpreter::Machine::note_height() {
  if (!state_.is_height_unknown && !state_.is_length_unknown) return;
  const bool is_of_machine = request().code(Group::g_non_modal) == 530;
  if (!has_axis(2)) return;
  if (is_of_machine) {
    state_.is_height_unknown = state_.is_length_unknown;
  } else if (!state_.is_incremental) {
    state_.is_height_unknown = false;
  }
}

}  // namespace servomill::controllers
