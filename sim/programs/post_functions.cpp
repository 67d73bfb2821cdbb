#include "sim/programs/post_functions.h"

#include <fmt/format.h>

#include <cmath>

namespace servomill::sim::programs {
namespace {

constexpr double kTimeTolerance = 1e-6;  // s; relative of speeds

}  // namespace

bool is_retracted(const Joints& Q, const controllers::PostOptions& options) {
  constexpr int kZ = 2;
  return std::abs(Q[kZ] - options.safe.retract_Z) <= kPostJoint;
}

void PostFunctions::expect(const controllers::ClRecord& record) {
  switch (record.kind) {
    case MoveKind::tool:
      tools_.push_back(record.number);
      changes_tool_ = true;
      break;
    case MoveKind::spindle:
      wanted_.direction = record.direction;
      wanted_.speed = record.value;
      break;
    case MoveKind::coolant:
      wanted_.coolant = record.number;
      break;
    default:
      events_.push_back(&record);
  }
}

std::string PostFunctions::act(const Move& move, PostState& now, bool off_place) {
  switch (move.kind) {
    case MoveKind::tool:
      return change_tool(move, now);
    case MoveKind::spindle:
      if (move.direction == 0 && now.direction != 0) stopped_in_ = move.line;
      now.direction = move.direction;
      now.speed = move.value;
      return {};
    case MoveKind::coolant:
      now.coolant = move.number;
      return {};
    case MoveKind::end:
      return is_safe() && stopped_in_ == move.line ? "the program ends with the spindle on" : "";
    default:
      return take_event(move, off_place);
  }
}

std::string PostFunctions::change_tool(const Move& move, PostState& now) {
  if (tools_.empty() || tools_.front() != move.number) {
    return fmt::format("tool {} is loaded, which the cutter locations do not call", move.number);
  }
  wanted_.tool = now.tool = tools_.front();
  tools_.pop_front();
  if (!is_safe()) return {};
  if (!is_retracted(now.Q, options_)) return "the tool is changed below the retract height";
  if (now.direction != 0 || now.coolant != 0 || stopped_in_ == move.line) {
    return "the tool is changed while the spindle or the coolant is on";
  }
  return {};
}

std::string PostFunctions::take_event(const Move& move, bool off_place) {
  const bool is_wanted = !events_.empty() && events_.front()->kind == move.kind &&
                         (move.kind != MoveKind::stop || events_.front()->number == move.number) &&
                         (move.kind != MoveKind::dwell ||
                          std::abs(events_.front()->value - move.value) <= kTimeTolerance);
  if (!is_wanted) return "a dwell, stop or message that the cutter locations do not have here";
  events_.pop_front();
  return move.kind == MoveKind::dwell && off_place ? "the dwell is not at its location" : "";
}

std::string PostFunctions::fault_of(const PostState& now) const {
  if (!events_.empty()) return "a dwell, stop or message before this location is missing";
  if (!tools_.empty()) return fmt::format("tool {} is not loaded", tools_.front());
  if (now.tool != wanted_.tool) return fmt::format("tool {} is in the spindle", now.tool);
  const bool same_speed =
      std::abs(now.speed - wanted_.speed) <= kTimeTolerance * std::abs(wanted_.speed);
  if (now.direction != wanted_.direction || (wanted_.direction != 0 && !same_speed)) {
    return "the spindle does not run as the cutter locations specify";
  }
  if (now.coolant != wanted_.coolant) return "the coolant is not as the cutter locations specify";
  return {};
}

std::string PostFunctions::arrive(const PostState& now) {
  changes_tool_ = false;
  return fault_of(now);
}

}  // namespace servomill::sim::programs
