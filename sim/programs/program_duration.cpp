#include "sim/programs/program_duration.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "controllers/path/tcp_motion.h"
#include "controllers/path/travel.h"
#include "sim/model/machine.h"
#include "sim/preparation/case_program.h"

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

controllers::TipMotions tip_motions_of(const MoveList& moves, const Joints& start,
                                       const DurationSettings& settings,
                                       const controllers::JointLimits& limits,
                                       const controllers::PathOptions& options) {
  const auto controls_tip = [](const Move& move) {
    return is_motion(move.kind) && move.tool_control != ToolControl::none;
  };
  if (!settings.tool_centre_point || !first_move(moves, controls_tip)) return {};
  return controllers::tip_motions(moves, *settings.tool_centre_point,
                                  preparation::tips_of(moves, *settings.tools), start, limits,
                                  options, settings.file);
}

ProgramDuration::ProgramDuration(const model::MachineSettings& machine, DurationSettings settings)
    : machine_(machine),
      settings_(std::move(settings)),
      limits_{machine.nc.v_max, machine.nc.a_max, machine.nc.j_max},
      options_(preparation::path_options(machine.nc, settings_.feed_override)),
      start_(settings_.start),
      why_unknown_(missing_limits(machine)) {}

// Moves that cannot be planned make the time unknown.
bool ProgramDuration::refuses(const Move& move) {
  if (!why_unknown_.empty()) return true;
  const JointLayout& layout = machine_.chain.layout;
  for (const Axis axis : kAllAxes) {
    if (layout.joint_of(axis) || move.end_machine[index_of(axis)] == 0.0) continue;
    why_unknown_ =
        fmt::format("line {} moves {}, but the machine has no such axis", move.line, letter(axis));
  }
  if (move.tool_control != ToolControl::none && !settings_.tool_centre_point) {
    why_unknown_ = fmt::format(
        "line {} is under tool-centre-point control or in a tilted plane; servomill time plans it",
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
  if (moves_.empty()) return;
  controllers::TipMotions tip = tip_motions_of(moves_, start_, settings_, limits_, options_);
  const JointLayout& layout = machine_.chain.layout;
  const controllers::Trajectory trajectory =
      controllers::plan(moves_, layout, start_, limits_, options_, tip);
  duration_ += trajectory.duration();
  if (settings_.on_part) {
    const auto slowed = controllers::slowed_inverse_time(moves_, layout, start_, limits_, options_);
    if (slowed) tip.slowed.push_back(*slowed);
    settings_.on_part({moves_, files_, start_, trajectory, tip.slowed,
                       controllers::travel_faults(moves_, layout, start_, machine_.nc.lower,
                                                  machine_.nc.upper, settings_.file, tip)});
  }
  start_ = trajectory.end();
  moves_ = {};
  files_.clear();
}

// Behind a move that is left out.
Joints ProgramDuration::joints_at_end(const Move& move) const {
  const JointLayout& layout = machine_.chain.layout;
  if (move.tool_control == ToolControl::none) return layout.joints(move.end_machine);
  const auto* tool = settings_.tools->find(move.tool_offset);
  const Eigen::Vector3d p_ST =
      tool != nullptr ? Eigen::Vector3d(-tool->offset.head<3>()) : Eigen::Vector3d::Zero();
  const auto words = settings_.tool_centre_point->machine_words(move.end_machine, p_ST);
  return layout.joints(words.value_or(move.end_machine));
}

void ProgramDuration::add(const Move& move, bool is_known, std::uint16_t file) {
  if (refuses(move)) return;
  const bool is_boundary = (move.kind == MoveKind::rapid) != (last_ == MoveKind::rapid);
  last_ = move.kind;
  if (moves_.size() >= kMovesAtOnce && is_boundary) plan();
  if (is_known) {
    moves_.push_back(move);
    files_.push_back(file);
    return;
  }
  plan();
  left_out_.push_back(move.line);
  start_ = joints_at_end(move);
}

void ProgramDuration::add_other(const Move& move, std::uint16_t file) {
  const bool is_unknown = move.kind == MoveKind::dwell && std::isnan(move.value);
  if (is_unknown) ++unknown_dwells_;
  if (is_unknown || !why_unknown_.empty()) return;
  moves_.push_back(move);
  files_.push_back(file);
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
