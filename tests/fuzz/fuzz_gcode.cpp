// Syntax and interpretation of a program. Laws: a fault has its place in the program; behind it the
// reading goes on with the next block; moves are finite, their lengths follow on each other;
// `check` finds a fault where running does.
#include <fmt/format.h>

#include <cmath>

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/programs.h"

namespace servomill::fuzz {
namespace {

bool is_finite(const Move& move) {
  const double sum = move.end.sum() + move.end_machine.sum() + move.arc.centre.sum() +
                     move.centre_machine.sum() + move.tool_axis.sum();
  return std::isfinite(sum) && std::isfinite(move.feed) && std::isfinite(move.value) &&
         std::isfinite(move.path_tolerance) && std::isfinite(move.s_begin) &&
         std::isfinite(move.s_end);
}

// All moves, over all faults; the number of faults.
std::size_t run(std::string_view text, const controllers::ProgramSetup& setup) {
  controllers::Interpreter interpreter(std::string(text), std::string(kProgram), setup);
  std::size_t moves = 0, faults = 0;
  double s = 0.0;
  while (moves < kMostMoves) {
    try {
      const auto move = interpreter.next();
      if (!move) break;
      require(is_finite(*move), "moves are finite", fmt::format("line {}", move->line));
      require(
          move->s_begin == s && move->s_end >= s, "path lengths follow on each other",
          fmt::format("line {}: {} to {} behind {}", move->line, move->s_begin, move->s_end, s));
      s = move->s_end;
      ++moves;
    } catch (const InputError& error) {
      require_places(error.faults(), text, kProgram);
      ++faults;
    }
  }
  if (!interpreter.warnings().empty()) require_places(interpreter.warnings(), text, kProgram);
  return faults;
}

}  // namespace

void run(std::string_view text) {
  const auto setup = setup_for(text);
  const std::size_t faults = run(text, setup);
  if (text.size() > 4096) return;  // long ones once: the time allowed is that of one reading
  const auto found = controllers::check_program(std::string(text), std::string(kProgram), setup);
  if (!found.empty()) require_places(found, text, kProgram);
  // not the other way round: it goes on behind an end that only a run can see, M[1 + 1]
  require(!found.empty() || faults == 0, "check finds a fault where running does");
}

}  // namespace servomill::fuzz
