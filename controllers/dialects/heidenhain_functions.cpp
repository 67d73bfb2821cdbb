// M functions.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "controllers/dialects/heidenhain_control.h"

namespace servomill::controllers::heidenhain {
namespace {

constexpr int kFlood = 2;

// Functions that this reader covers. Those at the end of a block act after its motion ([155] p.
// 15).
struct Function {
  int number;
  bool is_at_start;
  int group;  // two of a group exclude each other in one block; 0: none
};

constexpr std::array<Function, 20> kFunctions = {{
    {0, false, 1},  {1, false, 1},  {2, false, 1},  {3, true, 2},   {4, true, 2},
    {5, false, 2},  {6, false, 1},  {8, true, 3},   {9, false, 3},  {13, true, 2},
    {14, true, 2},  {30, false, 1}, {91, true, 4},  {111, true, 0}, {117, true, 0},
    {126, true, 5}, {127, true, 5}, {129, true, 0}, {136, true, 6}, {137, true, 6},
}};

const Function* find_function(int m) {
  const auto* const found = std::find_if(kFunctions.begin(), kFunctions.end(),
                                         [m](const Function& f) { return f.number == m; });
  return found == kFunctions.end() ? nullptr : found;
}

}  // namespace

void Control::check_functions(const Positioning& p) const {
  for (int i = 0; i < p.functions_count; ++i) {
    const Place& place = p.functions[i]->place;
    const int m = p.m[i];
    if (m == 140) continue;
    if (m == 7) fail(place, "M7 is defined by the machine builder");
    if (m == 92)
      fail(place, "M92: the machine builder's reference point is unknown; use M91 (machine datum)");
    if (m == 128) fail(place, "M128: TCP control is not covered by the verification");
    if (!find_function(m)) {
      fail(place, fmt::format("M{}: not covered by the verification", m));
    }
  }
  if (p.functions_count < 2) return;
  const Function* first = find_function(p.m[0]);
  const Function* second = find_function(p.m[1]);
  const bool clash = first && second && first->group != 0 && first->group == second->group;
  const bool coolant_clash = (p.has_m(13) || p.has_m(14)) && (p.has_m(8) || p.has_m(9));
  if (p.m[0] == p.m[1] || clash || coolant_clash) {
    fail(p.functions[1]->place, fmt::format("M{} and M{} in one block", p.m[0], p.m[1]));
  }
}

bool Control::is_at_block_start(int m) const {
  if (m == 3 || m == 4 || m == 8 || m == 13 || m == 14) return rules_.m3_acts_at_block_start;
  if (m == 5 || m == 9) return !rules_.m5_acts_at_block_end;
  const Function* function = find_function(m);
  return function && function->is_at_start;
}

void Control::act_at_start(const Positioning& p) {
  for (int i = 0; i < p.functions_count; ++i) {
    if (is_at_block_start(p.m[i])) act(p.m[i], *p.functions[i]);
  }
}

// Stops and program ends act after all other functions at the end of the block.
void Control::act_at_end(const Positioning& p) {
  constexpr std::array<int, 5> kLast = {0, 1, 2, 6, 30};
  for (const bool is_last : {false, true}) {
    for (int i = 0; i < p.functions_count; ++i) {
      const bool comes_last = std::find(kLast.begin(), kLast.end(), p.m[i]) != kLast.end();
      if (!is_at_block_start(p.m[i]) && comes_last == is_last) act(p.m[i], *p.functions[i]);
    }
  }
}

void Control::act(int m, const HeidenhainWord& word) {
  switch (m) {
    case 0:
    case 1:
      return stop(m, word);
    case 2:
    case 30:
      emit(ActionKind::end, word.place).number = m;
      is_at_end_ = true;
      return;
    case 3:
    case 13:
      turn_spindle(1, word);
      if (m == 13 && rules_.m13_switches_coolant) switch_coolant(true, word.place);
      return;
    case 4:
    case 14:
      turn_spindle(-1, word);
      if (m == 14 && rules_.m13_switches_coolant) switch_coolant(true, word.place);
      return;
    case 5:
      return turn_spindle(0, word);
    case 6:
      if (settings_.is_m6_halting) emit(ActionKind::stop, word.place);
      return forget_tool_change();
    case 8:
    case 9:
      return switch_coolant(m == 8, word.place);
    default:
      return act_on_mode(m, word);
  }
}

void Control::act_on_mode(int m, const HeidenhainWord& word) {
  if (m == 117) state_.is_rotary_feed_in_mm = false;
  if (m == 126 || m == 127) state_.is_shorter_path = m == 126;
  if (m == 136 || m == 137) {
    if (state_.is_per_revolution != (m == 136)) state_.feed.reset();  // another unit
    state_.is_per_revolution = m == 136;
  }
  if (m == 129) {
    require_tilting(word.place, "M129");
    state_.is_tcp_control = false;
  }
}

void Control::turn_spindle(int direction, const HeidenhainWord& word) {
  if (direction != 0 && !state_.speed) {
    fail(word.place,
         fmt::format("{} requires S; none programmed since the last TOOL CALL", word.text));
  }
  state_.direction = direction;
  MachineAction& action = emit(ActionKind::spindle, word.place);
  action.direction = direction;
  action.value = direction == 0 ? 0.0 : *state_.speed;
}

void Control::switch_coolant(bool is_on, const Place& place) {
  emit(ActionKind::coolant, place).number = is_on ? kFlood : 0;
}

// M0 and M1 stop the spindle and the coolant ([155] p. 15), and the operator may move axes. M1
// acts where the operator's switch is on.
void Control::stop(int number, const HeidenhainWord& word) {
  const bool acts = number == 0 || settings_.is_optional_stop_on;
  if (acts && settings_.is_stop_switching_off && rules_.stop_switches_off) {
    turn_spindle(0, word);
    switch_coolant(false, word.place);
  }
  if (rules_.stop_forgets_positions) forget_positions();
  emit(ActionKind::stop, word.place).number = number;
  if (rules_.stop_forgets_positions) state_.pole.reset();
}

}  // namespace servomill::controllers::heidenhain
