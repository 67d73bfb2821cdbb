#include "sim/programs/verification/linuxcnc_replay.h"

namespace servomill::sim::programs {
namespace {

using controllers::ActionKind;
using controllers::MachineAction;

MachineAction action_of(const OriginalAction& original) {
  const Move& move = original.move;
  MachineAction out;
  out.kind = kind_of(move.kind);
  if (move.kind == MoveKind::feed && move.number != 0) out.kind = ActionKind::probe;
  out.line = move.line;
  const AxisFlags6 changed = original.changed();
  for (int i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out.is_commanded[k] = is_motion(move.kind) && (original.is_named[k] || changed[k]);
    out.end[k] = is_motion(move.kind) ? move.end_machine[i] : original.begin[i];
  }
  out.is_machine_position = original.is_machine_position;
  out.is_to_reference = original.is_to_reference;
  out.normal_axis = move.arc.normal_axis;
  out.centre = move.centre_machine;
  out.turns = move.arc.turns;
  const bool is_per_revolution = move.feed_mode == FeedMode::units_per_revolution;
  out.feed_mode = is_per_revolution ? move.feed_mode : FeedMode::units_per_minute;
  out.feed = is_per_revolution ? move.value : move.feed;
  out.path_mode = move.path_mode;
  out.is_path_mode_known = original.has_path_mode;
  if (move.path_tolerance > 0.0) out.path_tolerance = move.path_tolerance;
  out.tool_offset = move.tool_offset;
  out.value = move.value;
  out.number = move.number;
  return out;
}

// Spindle and coolant as actions of their own, where they have changed.
void put_auxiliary(const OriginalAction& original, AuxiliaryState& last,
                   std::vector<MachineAction>& out) {
  const AuxiliaryState& now = original.auxiliary;
  MachineAction action;
  action.line = original.move.line;
  if (now.direction && (now.direction != last.direction || now.speed != last.speed)) {
    action.kind = ActionKind::spindle;
    action.direction = *now.direction;
    action.value = now.speed;
    out.push_back(action);
  }
  if (now.coolant && now.coolant != last.coolant) {
    action.kind = ActionKind::coolant;
    action.number = *now.coolant;
    out.push_back(action);
  }
  last = now;
}

}  // namespace

std::vector<MachineAction> replay_linuxcnc(const std::string& text, const std::string& file,
                                           const controllers::ProgramSetup& setup,
                                           const OriginalOptions& options) {
  Original program(controllers::ProgramText::of_text(text, file), setup, options);
  std::vector<MachineAction> out;
  AuxiliaryState last;
  while (const OriginalAction* action = program.next()) {
    put_auxiliary(*action, last, out);
    out.push_back(action_of(*action));
    if (action->move.kind == MoveKind::tool) last.direction.reset();
  }
  return out;
}

}  // namespace servomill::sim::programs
