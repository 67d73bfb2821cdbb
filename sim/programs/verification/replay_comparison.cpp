#include "sim/programs/verification/replay_comparison.h"

#include "sim/programs/verification/travel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::sim::programs {
namespace {

using controllers::ActionKind;

constexpr double kSame = 1e-10;      // m, rad: one number read in two ways
constexpr double kDwellTol = 1e-3;   // s, three decimals
constexpr double kSpeedTol = 0.501;  // rpm, S as an integer
constexpr int kPalletStop = 60;

std::string_view name_of(ActionKind kind) {
  constexpr std::string_view kNames[] = {"a rapid", "a feed",        "an arc",
                                         "a dwell", "a tool change", "a spindle",
                                         "coolant", "a stop",        "the end of the program"};
  return kNames[static_cast<int>(kind)];
}

bool is_auxiliary(ActionKind kind) {
  return kind == ActionKind::spindle || kind == ActionKind::coolant;
}

}  // namespace

bool commands_only_Z(const controllers::MachineAction& action) {
  for (std::size_t i = 0; i < action.is_commanded.size(); ++i) {
    if (action.is_commanded[i] != (i == 2)) return false;
  }
  return true;
}

std::string place_text(const AxisWords& position, const JointLayout& layout) {
  std::string out;
  for (const Axis axis : kAllAxes) {
    if (!layout.joint_of(axis)) continue;
    out += fmt::format("{}{}{:.5g}", out.empty() ? "" : " ", letter(axis),
                       position[index_of(axis)] / (is_linear(axis) ? mm : deg));
  }
  return out;
}

ReplayComparison::ReplayComparison(const std::vector<Action>& replay,
                                   const ComparisonLimits& limits, Correction& correction)
    : replay_(replay), limits_(limits), correction_(correction) {}

void ReplayComparison::fail(const std::string& why) const {
  throw ReplayDifference{why, next_ < replay_.size() ? replay_[next_].line : 0};
}

bool ReplayComparison::is_still(const Action& action) const {
  if (action.kind != ActionKind::rapid && action.kind != ActionKind::feed) return false;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    if (!action.is_commanded[i]) continue;
    if (!at_[i] || !action.end[i] || std::abs(*at_[i] - *action.end[i]) > kSame) return false;
  }
  return true;
}

// The next action that is neither spindle nor coolant nor a motion to where the machine is.
const controllers::MachineAction* ReplayComparison::peek() {
  take_auxiliary();
  while (next_ < replay_.size() && is_still(replay_[next_])) {
    check_retract(replay_[next_]);
    note_named(replay_[next_]);
    ++next_;
    take_auxiliary();
  }
  return next_ < replay_.size() ? &replay_[next_] : nullptr;
}

const controllers::MachineAction& ReplayComparison::need(const std::string& what) {
  const Action* one = peek();
  if (one == nullptr) fail(fmt::format("{} is missing; the written program has ended", what));
  return *one;
}

void ReplayComparison::arrive(const Action& action) {
  check_retract(action);
  note_named(action);
  at_ = action.end;
  ++next_;
  ++blocks_;
}

AxisWords ReplayComparison::known_position() const {
  AxisWords out = AxisWords::Zero();
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const Axis axis = kAllAxes[i];
    if (!correction_.layout().joint_of(axis)) continue;
    if (!at_[i]) fail(fmt::format("feeds while the position of {} is unknown", letter(axis)));
    out[static_cast<int>(i)] = *at_[i];
  }
  return out;
}

// ------------------------------------------------------------------------- spindle and coolant

void ReplayComparison::take_auxiliary() {
  for (; next_ < replay_.size() && is_auxiliary(replay_[next_].kind); ++next_) {
    const Action& one = replay_[next_];
    if (one.line != auxiliary_line_) auxiliary_before_line_ = auxiliary_;
    auxiliary_line_ = one.line;
    if (one.kind == ActionKind::spindle) {
      auxiliary_.direction = one.direction;
      auxiliary_.speed = one.value;
    } else {
      auxiliary_.coolant = one.number;
    }
  }
}

// Before rapids the written program may leave open what the original has switched on, as safe
// frames do after a tool change; before feeds it may not.
void ReplayComparison::compare_auxiliary(const OriginalAction& action, bool is_strict) const {
  const AuxiliaryState& wanted = action.auxiliary;
  const int direction = wanted.direction.value_or(0);
  if (is_strict ? auxiliary_.direction.value_or(0) != direction
                : auxiliary_.direction && *auxiliary_.direction != direction) {
    fail(fmt::format("the spindle must be {}, but is {}",
                     direction > 0   ? "on (M3)"
                     : direction < 0 ? "on (M4)"
                                     : "off",
                     !auxiliary_.direction        ? "in an unknown state"
                     : *auxiliary_.direction == 0 ? "off"
                     : *auxiliary_.direction > 0  ? "on (M3)"
                                                  : "on (M4)"));
  }
  const bool runs = direction != 0 && auxiliary_.direction.value_or(0) != 0;
  if (runs && std::abs(auxiliary_.speed - wanted.speed) > kSpeedTol * rpm) {
    fail(fmt::format("the spindle must run at {:g} rpm, but runs at {:g} rpm", wanted.speed / rpm,
                     auxiliary_.speed / rpm));
  }
  const int coolant = wanted.coolant.value_or(0);
  if (is_strict ? auxiliary_.coolant.value_or(0) != coolant
                : auxiliary_.coolant && *auxiliary_.coolant != coolant) {
    fail(fmt::format("coolant must be {}, but is {}", coolant == 0 ? "off" : "on",
                     coolant == 0              ? "on"
                     : auxiliary_.coolant == 0 ? "off"
                                               : "another or in an unknown state"));
  }
}

// ------------------------------------------------------------------- what is no motion, and frames

// Retracts along Z alone, to the height of the frames or to the reference position.
void ReplayComparison::skip_retracts(const OriginalAction* before) {
  while (const Action* one = peek()) {
    const bool is_retract =
        one->kind == ActionKind::rapid && one->is_machine_position && commands_only_Z(*one);
    if (!is_retract) return;
    const bool is_height = limits_.retract && one->end[2] &&
                           std::abs(*one->end[2] - *limits_.retract) < 0.5 * limits_.grid + kSame;
    if (!one->is_to_reference && !is_height) return;
    // it may be the original's own
    if (before != nullptr && before->is_machine_position) {
      const bool is_its_own = before->is_to_reference ||
                              (one->end[2] && is_height && before->is_named[2] &&
                               std::abs(*one->end[2] - before->move.end_machine[2]) < limits_.grid);
      if (is_its_own) return;
    }
    arrive(*one);
  }
}

// Some controls switch the spindle off in the block of the stop.
void ReplayComparison::compare_stop(const OriginalAction& action, const Action& one) {
  const bool is_pallet = action.move.number == kPalletStop && !limits_.is_linuxcnc;
  const int number = is_pallet ? 0 : action.move.number;
  if (one.number != number) fail(fmt::format("expected M{}, found M{}", number, one.number));
  const AuxiliaryState after = auxiliary_;
  if (auxiliary_line_ == one.line && !limits_.is_linuxcnc) auxiliary_ = auxiliary_before_line_;
  if (has_moved_since_stop_) compare_auxiliary(action, true);
  auxiliary_ = after;
  has_moved_since_stop_ = false;
}

// The frame of a program for another control: Z is retracted first and last.
void ReplayComparison::check_retract(const Action& action) {
  const bool is_retract =
      action.kind == ActionKind::rapid && action.is_machine_position && commands_only_Z(action);
  const bool is_clear =
      action.is_to_reference || !limits_.retract ||
      (action.end[2] && std::abs(*action.end[2] - *limits_.retract) < limits_.grid);
  if (action.is_commanded[2]) is_retracted_ = is_retract && is_clear;
  if (!has_motion_ && !is_retract && !limits_.is_linuxcnc) {
    fail("the first motion is not a retract of Z in machine coordinates");
  }
  has_motion_ = has_moved_since_stop_ = true;
}

void ReplayComparison::match_other(const OriginalAction& action) {
  const ActionKind kind = kind_of(action.move.kind);
  const bool has_frame = kind == ActionKind::tool || kind == ActionKind::end;
  if ((has_frame || is_behind_pallets_ || !has_motion_) && !limits_.is_linuxcnc) {
    skip_retracts(nullptr);
  }
  const Action& one = need(std::string(name_of(kind)));
  if (one.kind != kind) {
    fail(fmt::format("expected {}, found {}", name_of(kind), name_of(one.kind)));
  }
  if (kind == ActionKind::tool && one.number != action.move.number) {
    fail(fmt::format("tool {} must be called, but {} is", action.move.number, one.number));
  }
  if (kind == ActionKind::dwell && std::abs(one.value - action.move.value) > kDwellTol) {
    fail(fmt::format("the dwell must last {:g} s, but lasts {:g} s", action.move.value, one.value));
  }
  if (kind == ActionKind::stop) compare_stop(action, one);
  if (kind == ActionKind::dwell) compare_auxiliary(action, false);
  const bool ends_coolant = action.auxiliary.coolant == 0 && auxiliary_.coolant.value_or(0) != 0;
  if (kind != ActionKind::stop && kind != ActionKind::dwell && ends_coolant) {
    fail("coolant must be off, but is on");
  }
  const bool ends_spindle = kind == ActionKind::end && action.auxiliary.direction == 0 &&
                            auxiliary_.direction.value_or(0) != 0;
  if (ends_spindle) fail("the spindle must be off, but is on");
  const bool needs_retract = kind == ActionKind::end && has_motion_ && !limits_.is_linuxcnc;
  if (needs_retract && !is_retracted_) fail("ends without a retract of Z in machine coordinates");
  const bool is_dwell = kind == ActionKind::dwell;
  if (!is_dwell) at_ = one.end;
  const bool is_pallet = kind == ActionKind::stop && action.move.number == kPalletStop;
  if (kind == ActionKind::tool || is_pallet) unmoved_ = {};
  is_behind_pallets_ = is_pallet;
  if (kind == ActionKind::tool) has_moved_since_stop_ = false;
  const bool is_stop = kind == ActionKind::stop && !limits_.is_linuxcnc;
  if (kind == ActionKind::tool || is_stop) is_lost_.fill(true);
  if (kind == ActionKind::tool) {
    auxiliary_.direction.reset();
    if (!limits_.is_linuxcnc) auxiliary_.coolant.reset();
  }
  has_ended_ = kind == ActionKind::end;
  ++next_;
  ++blocks_;
}

void ReplayComparison::match(const OriginalAction& action) {
  if (!is_motion(action.move.kind)) {
    const bool is_lost = action.move.kind == MoveKind::tool || action.move.kind == MoveKind::stop;
    if (is_lost && !limits_.is_linuxcnc) directions_.fill(0);
    return match_other(action);
  }
  if (!limits_.is_linuxcnc) skip_restated(action);
  for (const OriginalAction& piece : pieces_of(as_known(action), correction_)) {
    turn(directions_, piece);
    correction_.set_directions(directions_);
    match_motion(piece);
  }
}

void ReplayComparison::match_motion(const OriginalAction& action) {
  correction_.set_tool(action.p_ST);
  if (!has_moved_ && !limits_.is_linuxcnc) skip_retracts(&action);
  has_moved_ = true;
  is_behind_pallets_ = false;
  if (action.is_machine_position) return match_place(action);
  if (action.move.kind == MoveKind::rapid && !is_corrected_rapid(action))
    return match_rapid(action);
  match_path(action);
}

// Before every axis has a position, the errors on its way are not known.
bool ReplayComparison::is_corrected_rapid(const OriginalAction& action) const {
  if (!limits_.corrects_rapids) return false;
  for (std::size_t i = 0; i < action.is_known.size(); ++i) {
    const bool is_there = correction_.layout().joint_of(kAllAxes[i]).has_value();
    if (is_there && (!action.was_known[i] || !at_[i])) return false;
  }
  return true;
}

void ReplayComparison::finish() {
  if (!limits_.is_linuxcnc && !has_ended_) skip_retracts(nullptr);
  const Action* one = peek();
  const bool is_end = one != nullptr && one->kind == ActionKind::end && !has_ended_;
  if (is_end) {
    ++next_;
    one = peek();
  }
  if (one != nullptr)
    fail(fmt::format("{} comes after the end of the original", name_of(one->kind)));
}

}  // namespace servomill::sim::programs
