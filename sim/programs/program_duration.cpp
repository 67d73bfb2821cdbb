#include "sim/programs/program_duration.h"

#include <fmt/format.h>

#include <cmath>

namespace servomill::sim::programs {
namespace {

// The planner stops between rapid and feed: from so many moves on, the next such place ends a part
// that is planned for itself, so that long programs are not held.
constexpr std::size_t kMovesAtOnce = 20'000;

std::string missing_limits(const model::MachineSettings& machine) {
  std::string axes;
  for (const int j : machine.joints()) {
    const model::NcSettings& nc = machine.nc;
    if (nc.v_max[j] > 0.0 && nc.a_max[j] > 0.0 && nc.j_max[j] > 0.0) continue;
    axes += fmt::format("{}{}", axes.empty() ? "" : ", ", machine.chain.layout.letter_of(j));
  }
  return axes.empty() ? ""
                      : fmt::format("the machine file lacks v_max, a_max or j_max of {}", axes);
}

}  // namespace

ProgramDuration::ProgramDuration(const model::MachineSettings& machine)
    : machine_(machine),
      limits_{machine.nc.v_max, machine.nc.a_max, machine.nc.j_max},
      why_unknown_(missing_limits(machine)) {
  options_.tolerance = machine.nc.path_tolerance;
  options_.rotary_tolerance = machine.nc.rotary_tolerance;
  options_.block_time = machine.nc.block_time;
  options_.tolerance_share = machine.nc.tolerance_share;
}

// Moves that cannot be planned make the time unknown.
bool ProgramDuration::refuses(const Move& move) {
  if (!why_unknown_.empty()) return true;
  const JointLayout& layout = machine_.chain.layout;
  for (const Axis axis : kAllAxes) {
    if (layout.joint_of(axis) || move.end_machine[index_of(axis)] == 0.0) continue;
    why_unknown_ =
        fmt::format("line {} moves {}, but the machine has no such axis", move.line, letter(axis));
  }
  if (move.tool_control != ToolControl::none) {
    why_unknown_ = fmt::format(
        "line {} is under tool-centre-point control or in a tilted plane; a scenario simulates it",
        move.line);
  }
  if (move.kind != MoveKind::rapid && move.feed == 0.0) {
    why_unknown_ = fmt::format("line {} feeds per revolution with the spindle off", move.line);
  }
  if (std::isnan(move.feed)) {
    why_unknown_ =
        fmt::format("the feed of line {} is unknown; if no F precedes it, pass --feed", move.line);
  }
  if (!why_unknown_.empty()) moves_ = {};
  return !why_unknown_.empty();
}

void ProgramDuration::plan() {
  if (!moves_.empty()) {
    duration_ +=
        controllers::plan(moves_, machine_.chain.layout, start_, limits_, options_).duration();
  }
  moves_ = {};
  start_ = at_;
}

void ProgramDuration::add(const Move& move, const MoveKnowledge& known) {
  if (refuses(move)) return;
  const bool is_boundary = (move.kind == MoveKind::rapid) != (last_ == MoveKind::rapid);
  last_ = move.kind;
  if (moves_.size() >= kMovesAtOnce && is_boundary) plan();
  if (known.distance_is_known) {
    moves_.push_back(move);
    at_ = machine_.chain.layout.joints(move.end_machine);
    return;
  }
  plan();
  left_out_.push_back(move.line);
  start_ = at_ = machine_.chain.layout.joints(move.end_machine);
}

void ProgramDuration::add(const Move& move) {
  if (move.kind == MoveKind::tool) ++tool_changes_;
  if (move.kind == MoveKind::stop) ++stops_;
  const bool is_unknown = move.kind == MoveKind::dwell && std::isnan(move.value);
  if (is_unknown) ++unknown_dwells_;
  if (is_unknown || move.kind == MoveKind::message) return;
  if (why_unknown_.empty()) moves_.push_back(move);
}

void ProgramDuration::add_unknown_moves(std::string_view whose, int line) {
  const auto found = unknown_moves_.find(whose);
  if (found == unknown_moves_.end()) {
    unknown_moves_.emplace(whose, std::vector<int>{line});
  } else if (found->second.back() != line) {
    found->second.push_back(line);
  }
}

void ProgramDuration::finish() { plan(); }

}  // namespace servomill::sim::programs
