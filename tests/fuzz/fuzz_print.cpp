// Canonical moves printed as a program and read again. Law: moves of a machine's size come back, to
// print precision; what cannot be printed is refused.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "controllers/gcode/printer.h"
#include "plant/vocabulary/units.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/programs.h"

namespace servomill::fuzz {
namespace {

// Half a step of the seventh decimal, and the rounding of doubles at the largest size.
constexpr double kPrintTol = 0.6e-7 * mm;        // m
constexpr double kPrintAngleTol = 0.6e-7 * deg;  // rad
constexpr double kMaxLength = 100.0;             // m; what no machine has need not come back
constexpr double kMaxAngle = 1e6 * deg;          // rad
constexpr double kMaxRate = 1e6;                 // SI, of feed, speed and dwell
constexpr double kRateTol = 1e-11;               // relative, twelve digits

bool has_size_of_a_machine(const Move& move) {
  const auto is_small = [](const auto& p, double most) { return p.cwiseAbs().maxCoeff() < most; };
  return is_small(move.end.head<3>(), kMaxLength) && is_small(move.end.tail<3>(), kMaxAngle) &&
         is_small(move.arc.centre, kMaxLength) && std::abs(move.value) < kMaxRate &&
         move.feed < kMaxRate && move.path_tolerance < kMaxLength;
}

void require_same(const Move& a, const Move& b, std::string_view printed) {
  const auto details = fmt::format("line {} of\n{}", b.line, printed);
  // an arc that is shorter than the print precision becomes a line
  const bool became_line = a.kind == MoveKind::arc && b.kind == MoveKind::feed;
  require(a.kind == b.kind || became_line, "printed moves are of the same kind", details);
  require(a.number == b.number && a.direction == b.direction, "printed moves are the same",
          details);
  // shifts (G52, G92) are not printed: a move that stood behind one may have a way now, and with it
  // a feed of lengths in place of one of angles
  const bool same_way = (a.s_end > a.s_begin) == (b.s_end > b.s_begin);
  require(!same_way || std::abs(a.value - b.value) <= kRateTol * std::abs(a.value),
          "printed values are the same", details);
  if (!is_motion(a.kind)) return;
  require((a.end - b.end).head<3>().cwiseAbs().maxCoeff() <= kPrintTol &&
              (a.end - b.end).tail<3>().cwiseAbs().maxCoeff() <= kPrintAngleTol,
          "printed ends are the same", details);
  require(a.path_mode == b.path_mode && a.work_offset == b.work_offset &&
              a.tool_offset == b.tool_offset,
          "printed modes are the same", details);
  if (a.kind != MoveKind::arc || became_line) return;
  require(a.arc.normal_axis == b.arc.normal_axis && a.arc.turns == b.arc.turns,
          "printed arcs are the same", details);
}

}  // namespace

void run(std::string_view text) {
  const auto setup = setup_for(text);
  const auto moves = moves_until_fault(text, setup);
  for (const Move& move : moves) {
    if (!has_size_of_a_machine(move)) return;
  }
  std::string printed;
  try {
    printed = controllers::print_program(moves, {.start = setup.start}, text.substr(0, 300)).text;
  } catch (const InputError& error) {
    require(error.faults().front().place.line > 0, "a refusal names the line");
    return;
  }
  std::vector<Move> again;
  try {
    again = controllers::interpret(printed, "printed.ngc", setup);
  } catch (const InputError& error) {
    require(false, "a printed program is accepted", error.what() + ("\n" + printed));
  }
  // where a fault cut the moves off, the end that is added also turns spindle and coolant off
  const bool has_end = !moves.empty() && moves.back().kind == MoveKind::end;
  require(has_end ? again.size() == moves.size() : again.size() > moves.size(),
          "no printed move is missing or added", printed);
  for (std::size_t i = 0; i < moves.size(); ++i) require_same(moves[i], again[i], printed);
}

}  // namespace servomill::fuzz
