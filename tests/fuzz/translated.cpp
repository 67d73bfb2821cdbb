#include "tests/fuzz/translated.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/interpreter.h"
#include "tests/fuzz/fuzz.h"

namespace servomill::fuzz {
namespace {

constexpr std::size_t kMaxMoves = 20'000;

controllers::ProgramSetup setup_for(std::string_view text, controllers::Reader reader) {
  controllers::ProgramSetup setup;
  setup.reader = reader;
  if (text.size() % 4 != 3) {
    setup.tools = controllers::ToolTable::parse("T1 P1 Z100 D10\nT2 P2 Z50 D20\n", "tools.tbl");
  }
  setup.work_offset[0] = AxisWords::Constant(0.1);
  setup.block_delete = text.size() % 2 == 1;
  setup.most_jumps = 100;
  return setup;
}

void require_move(const Move& move, int lines, double s) {
  const std::string which = fmt::format("line {}", move.line);
  require(move.line >= 1 && move.line <= lines, "moves are of lines of the text", which);
  require(move.end_machine.allFinite() && std::isfinite(move.feed) && std::isfinite(move.value),
          "moves are finite", which);
  require(move.s_begin == s && move.s_end >= s, "path lengths follow on each other", which);
  require(move.kind != MoveKind::arc || move.arc.turns != 0, "arcs have a direction", which);
}

}  // namespace

void run_translated(std::string_view text, std::string_view file, controllers::Reader reader) {
  const int lines = 1 + static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  try {
    controllers::Interpreter interpreter(std::string(text), std::string(file),
                                         setup_for(text, reader));
    double s = 0.0;
    for (std::size_t moves = 0; moves < kMaxMoves; ++moves) {
      const Move* move = interpreter.next();
      if (move == nullptr) break;
      require_move(*move, lines, s);
      s = move->s_end;
    }
    const std::vector<Fault>& warnings = interpreter.warnings();
    if (!warnings.empty()) require_places(warnings, text, file);
  } catch (const InputError& error) {
    require(!error.faults().empty(), "an InputError has a fault");
    require_places(error.faults(), text, file);
  }
}

}  // namespace servomill::fuzz
