// Syntax and interpretation of a program. Laws: a fault has its place in the program; behind it the
// reading goes on with the next block; moves are finite, their lengths follow on each other;
// `check` finds a fault where running does.
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/programs.h"

namespace servomill::fuzz {
namespace {

// It runs to the end, however many lines a loop goes through.
constexpr std::size_t kMaxChecked = 4096;
// A loop may fail at every turn: a thrown fault costs a sanitizer more than a block does.
constexpr std::size_t kMaxFaults = 500;

bool is_finite(const Move& move) {
  const double sum = move.end.sum() + move.end_machine.sum() + move.arc.centre.sum() +
                     move.centre_machine.sum() + move.tool_axis.sum();
  return std::isfinite(sum) && std::isfinite(move.feed) && std::isfinite(move.value) &&
         std::isfinite(move.path_tolerance) && std::isfinite(move.s_begin) &&
         std::isfinite(move.s_end);
}

// All lines, over all faults; the number of faults.
std::size_t faults_in(controllers::Interpreter& interpreter, std::string_view text) {
  std::size_t faults = 0;
  double s = 0.0;
  for (std::size_t lines = 0; lines < kMaxLines && faults < kMaxFaults; ++lines) {
    try {
      const auto block = interpreter.next_block();
      if (!block) break;
      for (const Move& move : block->moves) {
        require(is_finite(move), "moves are finite", fmt::format("line {}", move.line));
        require(move.s_begin == s && move.s_end >= s, "path lengths follow on each other",
                fmt::format("line {}: {} to {} behind {}", move.line, move.s_begin, move.s_end, s));
        s = move.s_end;
      }
    } catch (const InputError& error) {
      require(!error.faults().empty(), "an InputError has a fault");
      require_program_places(error.faults(), text);
      ++faults;
    }
  }
  require_program_places(interpreter.warnings(), text);
  return faults;
}

// The same, where a program of another language is one fault.
std::size_t faults_of(std::string_view text, const controllers::ProgramSetup& setup) {
  std::optional<controllers::Interpreter> interpreter;
  try {
    interpreter.emplace(std::string(text), std::string(kProgram), setup);
  } catch (const InputError& error) {
    require_program_places(error.faults(), text);
    return 1;
  }
  return faults_in(*interpreter, text);
}

// Reads the text as each other control does: no law but those of faults_of.
void read_as_controls(std::string_view text) {
  auto setup = setup_for(text);
  for (const auto reader : {controllers::Reader::any, controllers::Reader::fanuc}) {
    setup.reader = reader;
    setup.decimal_point = reader == controllers::Reader::fanuc
                              ? controllers::DecimalPoint::increments
                              : controllers::DecimalPoint::unset;
    setup.feed = 5e-3;
    setup.additional_offsets[1] = setup.work_offset[1];
    faults_of(text, setup);
  }
}

}  // namespace

void run(std::string_view text) {
  read_as_controls(text);
  const auto setup = setup_for(text);
  const std::size_t faults = faults_of(text, setup);
  if (text.size() > kMaxChecked) return;
  const auto found = controllers::check_program(std::string(text), std::string(kProgram), setup);
  require_program_places(found, text);
  // not the other way round: it goes on behind an end that only a run can see, M[1 + 1]
  require(!found.empty() || faults == 0, "check finds a fault where running does");
}

}  // namespace servomill::fuzz
