// Rapids and places of the machine of a written program.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/programs/verification/replay_comparison.h"

namespace servomill::sim::programs {
namespace {

using controllers::ActionKind;

constexpr double kSame = 1e-10;  // m, rad: one number read in two ways
constexpr std::size_t kZ = 2;
constexpr int kMaxBlocks = 4;  // of a rapid: Z, X and Y, rotary axes, and one to restate

double unit_of(std::size_t axis) { return is_linear(kAllAxes[axis]) ? mm : deg; }
char name_of(std::size_t axis) { return letter(kAllAxes[axis]); }

}  // namespace

/// Positions that the axes of a rapid may end at.
struct ReplayComparison::Targets {
  AxisFlags6 is_required{}, is_allowed{};
  AxisWords corrected = AxisWords::Zero(), programmed = AxisWords::Zero();
  bool is_programmed_allowed = false;  // the errors are not known yet, or the axis keeps its place
};

bool ReplayComparison::is_at(std::size_t axis, double target) const {
  const double half = 0.5 * (axis <= kZ ? limits_.grid : limits_.grid_turn) * (1.0 + 1e-6);
  return at_[axis] && std::abs(*at_[axis] - target) <= half + kSame;
}

// ------------------------------------------------------------------- axes behind tool changes

void ReplayComparison::note_named(const Action& action) {
  for (std::size_t i = 0; i < at_.size(); ++i) {
    if (!action.is_commanded[i]) continue;
    unmoved_[i] = action.end[i];
    is_lost_[i] = false;
  }
}

// Without Z, of axes that a tool change or a stop has lost, to where the original has them.
bool ReplayComparison::restates(const OriginalAction& action, const Action& one) const {
  if (one.kind != ActionKind::rapid || one.is_commanded[kZ]) return false;
  bool is_any = false;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    if (!one.is_commanded[i]) continue;
    const double half = 0.5 * (i <= kZ ? limits_.grid : limits_.grid_turn) * (1.0 + 1e-6);
    const double begin = action.begin[static_cast<int>(i)];
    const bool is_back = one.end[i] && std::abs(*one.end[i] - begin) <= half + kSame;
    if (!is_lost_[i] || !action.was_ever_known[i] || !is_back) return false;
    is_any = true;
  }
  return is_any;
}

// Before a move of Z alone.
void ReplayComparison::skip_restated(const OriginalAction& action) {
  if (!action.moves_tip()) return;
  for (const Action* one = peek(); one != nullptr && restates(action, *one); one = peek()) {
    arrive(*one);
  }
}

void ReplayComparison::check_lost_axes(const OriginalAction& action) const {
  for (std::size_t i = 0; i < at_.size(); ++i) {
    if (i == kZ || !correction_.layout().joint_of(kAllAxes[i])) continue;
    if (!is_lost_[i] || !action.was_ever_known[i]) continue;
    fail(fmt::format(
        "moves Z where a tool change or stop has moved {}, which is known in the original",
        name_of(i)));
  }
}

// An axis that the written program has brought back is known; frames move no other axis than Z.
OriginalAction ReplayComparison::as_known(const OriginalAction& action) const {
  OriginalAction out = action;
  if (limits_.is_linuxcnc) return out;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    if (i == kZ || !at_[i] || is_lost_[i] || !action.was_ever_known[i]) continue;
    out.was_known[i] = out.is_known[i] = true;
  }
  return out;
}

ReplayComparison::Targets ReplayComparison::targets_of(const OriginalAction& action) {
  Targets out;
  const AxisFlags6 changed = action.changed();
  bool is_all_known = true;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    if (!correction_.layout().joint_of(kAllAxes[i])) continue;
    is_all_known &= action.is_known[i];
    const bool is_open = !at_[i] || !action.was_known[i] || action.is_machine_position;
    out.is_required[i] = changed[i] || (action.is_named[i] && is_open);
    const bool may_be_restated = !at_[i] && (action.was_ever_known[i] || limits_.is_linuxcnc);
    out.is_allowed[i] = changed[i] || action.is_named[i] || may_be_restated;
  }
  out.programmed = out.corrected = action.move.end_machine;
  if (action.is_machine_position) return out;
  out.corrected += correction_.at(action.move.end_machine, action.move.s_end);
  out.is_programmed_allowed = !is_all_known;
  return out;
}

bool ReplayComparison::is_reached(const Targets& targets) const {
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const int k = static_cast<int>(i);
    if (!targets.is_required[i] || is_at(i, targets.corrected[k])) continue;
    if (!targets.is_programmed_allowed || !is_at(i, targets.programmed[k])) return false;
  }
  return true;
}

// Axes, ends and the volume that a block of a rapid sweeps.
void ReplayComparison::check_rapid_block(const OriginalAction& action, const Targets& targets,
                                         const Action& one) {
  const bool may_feed = action.is_machine_position && action.move.kind == MoveKind::feed;
  if (one.kind != (may_feed ? ActionKind::feed : ActionKind::rapid)) {
    fail("expected a rapid, found another action");
  }
  if (one.is_machine_position != action.is_machine_position) {
    fail(action.is_machine_position ? "a machine position is written as a work position"
                                    : "a work position is written as a machine position");
  }
  bool moves_Z = false, moves_other = false, from_unknown = false;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    if (!one.is_commanded[i]) continue;
    if (at_[i] && one.end[i] && std::abs(*at_[i] - *one.end[i]) <= kSame) continue;
    (i == kZ ? moves_Z : moves_other) = true;
    from_unknown |= !at_[i];
    if (!targets.is_allowed[i]) {
      fail(fmt::format("moves {}, which is at rest in the original", name_of(i)));
    }
    if (!one.end[i]) fail(fmt::format("moves {} to an unknown position", name_of(i)));
  }
  // behind a stop Z may go up from where it was, if nobody has jogged
  const bool goes_up = unmoved_[kZ] && one.end[kZ] && *one.end[kZ] > *unmoved_[kZ] + kSame;
  if (moves_Z && !limits_.is_linuxcnc && !one.is_machine_position && !goes_up) {
    check_lost_axes(action);
  }
  if (!moves_Z || !moves_other || limits_.is_linuxcnc) return;
  if (from_unknown) fail("a rapid of Z together with other axes from an unknown position");
  if (!one.is_straight) {
    fail("a rapid of Z together with other axes, each at its own rate: the path is unknown");
  }
}

void ReplayComparison::match_rapid(const OriginalAction& action) {
  const Targets targets = targets_of(action);
  std::optional<double> z_begin;
  bool began_with_Z = false, began_without_Z = false;
  const bool moves = !is_reached(targets);
  for (int blocks = 0; !is_reached(targets); ++blocks) {
    if (!at_[kZ] && !limits_.is_linuxcnc && !action.is_machine_position) skip_retracts(&action);
    const Action& one = need("a rapid");
    if (blocks == kMaxBlocks) fail("the rapid ends at a wrong position");
    if (blocks == 0) z_begin = unmoved_[kZ];
    check_rapid_block(action, targets, one);
    const bool is_Z = one.is_commanded[kZ];
    bool is_other = false;
    for (std::size_t i = 0; i < at_.size(); ++i) is_other |= i != kZ && one.is_commanded[i];
    const auto z_end = one.end[kZ];
    if (is_Z && !is_other && !began_without_Z) began_with_Z = true;
    const bool goes_down = !z_begin || (z_end && *z_end < *z_begin - kSame);
    const bool goes_up = z_begin && z_end && *z_end > *z_begin + kSame;
    if (is_other && began_with_Z && !is_Z && goes_down && !limits_.is_linuxcnc) {
      fail("moves down before the other axes");
    }
    // from the height of the frames every way across is clear
    if (is_Z && began_without_Z && goes_up && !is_retracted_ && !limits_.is_linuxcnc) {
      fail("moves the other axes before moving up");
    }
    if (is_other && !is_Z) began_without_Z = true;
    const controllers::KnownPosition before = at_;
    arrive(one);
    for (std::size_t i = 0; i < at_.size(); ++i) {
      if (!one.is_commanded[i]) continue;
      const int k = static_cast<int>(i);
      const bool keeps = before[i] && std::abs(*before[i] - *at_[i]) <= kSame;
      if (keeps || is_at(i, targets.corrected[k])) continue;
      if (is_at(i, targets.programmed[k]) && targets.is_programmed_allowed) continue;
      --next_;
      fail(fmt::format("{} must end at machine position {:.5f}, but ends at {:.5f}", name_of(i),
                       targets.corrected[k] / unit_of(i), *at_[i] / unit_of(i)));
    }
  }
  // what is switched at a move of no length is compared at the next that has one
  if (moves) compare_auxiliary(action, false);
}

// LinuxCNC goes through the intermediate place of G28 as programmed, from the corrected one.
void ReplayComparison::skip_via(const OriginalAction& action) {
  const Action* one = limits_.is_linuxcnc ? peek() : nullptr;
  if (one == nullptr || one->kind != ActionKind::rapid) return;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    if (!one->is_commanded[i]) continue;
    const double via = action.move.end_machine[static_cast<int>(i)];
    if (!action.is_named[i] || !one->end[i] || std::abs(*one->end[i] - via) > kSame) return;
  }
  arrive(*one);
}

// G53: machine positions, to the digit.
void ReplayComparison::match_place(const OriginalAction& action) {
  const AxisFlags6 changed = action.changed();
  const bool is_via = !action.is_to_reference && action.is_reference_return;
  if (is_via && std::none_of(changed.begin(), changed.end(), [](bool one) { return one; })) {
    return skip_via(action);
  }
  if (is_via && !limits_.is_linuxcnc) {
    OriginalAction through = action;
    through.is_machine_position = false;
    through.is_named = {};
    return match_rapid(through);
  }
  if (action.is_to_reference && !limits_.is_linuxcnc) return match_reference(action);
  match_rapid(action);
}

bool ReplayComparison::is_return(const Action& one) const {
  const bool is_height = limits_.retract && commands_only_Z(one) && one.end[kZ] &&
                         std::abs(*one.end[kZ] - *limits_.retract) <= limits_.grid;
  return one.kind == ActionKind::rapid && one.is_machine_position &&
         (one.is_to_reference || is_height);
}

// A retract written where Z is there already moves nothing.
bool ReplayComparison::is_at_height_of_frames() const {
  return is_retracted_ && at_[kZ] && limits_.retract &&
         std::abs(*at_[kZ] - *limits_.retract) <= limits_.grid;
}

// G28, G30: another control's reference position, or the height of the frames.
void ReplayComparison::match_reference(const OriginalAction& action) {
  AxisFlags6 remaining = action.is_named;
  const AxisFlags6 changed = action.changed();
  for (std::size_t i = 0; i < remaining.size(); ++i) {
    remaining[i] = remaining[i] || changed[i];
    if (!correction_.layout().joint_of(kAllAxes[i])) remaining[i] = false;
  }
  while (std::any_of(remaining.begin(), remaining.end(), [](bool one) { return one; })) {
    const Action* next = peek();
    const bool returns = next != nullptr && is_return(*next);
    if (!returns && remaining[kZ] && is_at_height_of_frames()) {
      remaining[kZ] = false;
      continue;
    }
    const Action& one = need("a return to the reference position");
    if (!is_return(one)) {
      fail("expected a return to the reference position, found another action");
    }
    for (std::size_t i = 0; i < remaining.size(); ++i) {
      if (!one.is_commanded[i]) continue;
      if (!remaining[i]) fail(fmt::format("also moves {} to its reference position", name_of(i)));
      remaining[i] = false;
    }
    arrive(one);
  }
}

}  // namespace servomill::sim::programs
