// M70 M71 M72 M73: saving and restoring what is in force.
#include "controllers/gcode/saved_state.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "controllers/gcode/interpreter_machine.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

// LinuxCNC restores F and S by words that it writes with so many decimals.
double as_written(double value, int decimals) {
  return std::stod(fmt::format("{:.{}f}", value, decimals));
}

bool differ(double a, double b) {
  constexpr double kRounding = 1e-12;  // relative, of the way through SI
  return std::abs(a - b) > kRounding * std::max(std::abs(a), std::abs(b));
}

// M7, M8 and M9 as the two codes that LinuxCNC keeps for coolant; 0: nothing to restore.
int mist_code(int coolant) { return (coolant & kMist) != 0 ? 7 : (coolant & kFlood) != 0 ? 0 : 9; }
int flood_code(int coolant) { return (coolant & kFlood) != 0 ? 8 : 0; }

}  // namespace

SavedModes Interpreter::Machine::save_modal_state() const {
  SavedModes out;
  out.normal_axis = state_.normal_axis;
  out.is_uvw_plane = state_.is_uvw_plane;
  out.unit = state_.unit;
  out.is_incremental = state_.is_incremental;
  out.is_centre_absolute = state_.is_centre_absolute;
  out.retracts_to_r = state_.retracts_to_r;
  out.feed_mode = state_.feed_mode;
  out.work_system = state_.work_system;
  out.has_tool_offset = state_.tool_offset != AxisWords::Zero();
  out.controls_tip = state_.controls_tip();
  out.path_mode = state_.path_mode;
  out.path_tolerance = state_.path_tolerance;
  out.F = feed_in_force();
  out.S = state_.spindle_speed / rpm;
  out.spindle_direction = state_.spindle_direction;
  out.coolant = state_.coolant;
  out.feed_override = state_.feed_override;
  out.adaptive_feed = state_.adaptive_feed;
  out.feed_hold = state_.feed_hold;
  return out;
}

// LinuxCNC writes blocks with what differs and runs them: G20 or G21 first, so that F is read in
// the right unit, and the feed mode before F, which it would drop.
bool Interpreter::Machine::restore_modal_state(const SavedModes& saved) {
  if (saved.controls_tip != state_.controls_tip()) {
    fail(request().of(Group::m_spindle).column,
         "M72 cannot switch TCP control or a tilted work plane");
  }
  const bool new_unit = saved.unit != state_.unit;
  if (new_unit) state_.set_unit(saved.unit);
  const SavedModes now = save_modal_state();
  const bool new_mode = saved.feed_mode != now.feed_mode;
  if (new_mode) set_feed_mode(saved.feed_mode);
  const bool new_feed = differ(saved.F, now.F);
  if (new_feed) set_feed(as_written(saved.F, 1));
  const bool new_speed = differ(saved.S, now.S);
  if (new_speed) {
    state_.spindle_speed = as_written(saved.S, 0) * rpm;
    emit_spindle();
  }
  const bool new_m_codes = restore_m_codes(saved, now);
  const bool new_g_codes = restore_g_codes(saved, now);
  return new_unit || new_mode || new_feed || new_speed || new_m_codes || new_g_codes;
}

bool Interpreter::Machine::restore_m_codes(const SavedModes& saved, const SavedModes& now) {
  const auto differs = [](int wanted, int present) { return wanted != 0 && wanted != present; };
  const bool new_direction = saved.spindle_direction != now.spindle_direction;
  if (new_direction) {
    state_.spindle_direction = saved.spindle_direction;
    emit_spindle();
  }
  const bool new_mist = differs(mist_code(saved.coolant), mist_code(now.coolant));
  if (new_mist) state_.coolant = mist_code(saved.coolant) == 7 ? state_.coolant | kMist : 0;
  const bool new_flood = differs(flood_code(saved.coolant), flood_code(now.coolant));
  if (new_flood) state_.coolant |= kFlood;
  if (new_mist || new_flood) emit(MoveKind::coolant).number = state_.coolant;
  // M48 for a feed override that was on, M51 for one that was off: so LinuxCNC 2.9 does
  const bool new_override = saved.feed_override != now.feed_override;
  if (new_override) {
    state_.feed_override = state_.feed_override || saved.feed_override;
    state_.speed_override = true;
  }
  const bool new_switches =
      (saved.adaptive_feed && !now.adaptive_feed) || (saved.feed_hold && !now.feed_hold);
  state_.adaptive_feed = state_.adaptive_feed || saved.adaptive_feed;
  state_.feed_hold = state_.feed_hold || saved.feed_hold;
  return new_direction || new_mist || new_flood || new_override || new_switches;
}

bool Interpreter::Machine::restore_g_codes(const SavedModes& saved, const SavedModes& now) {
  const bool new_plane =
      saved.normal_axis != now.normal_axis || saved.is_uvw_plane != now.is_uvw_plane;
  state_.normal_axis = saved.normal_axis;
  state_.is_uvw_plane = saved.is_uvw_plane;
  const bool new_tool_offset = saved.has_tool_offset != now.has_tool_offset;
  if (new_tool_offset) {
    // G43 for the tool that is in the spindle now, or G49
    const AxisWords machine = machine_now(0);
    const int number = saved.has_tool_offset ? state_.tool : 0;
    state_.set_tool_offset(tool_named('T', number).offset);
    state_.tool_offset_number = number;
    stand_at(machine, 0);
  }
  const bool new_system = saved.work_system != now.work_system;
  if (new_system) load_work_system(saved.work_system);
  const bool new_path =
      saved.path_mode != now.path_mode || saved.path_tolerance != now.path_tolerance;
  state_.path_mode = saved.path_mode;
  state_.path_tolerance = saved.path_tolerance;
  const bool new_distance = saved.is_incremental != now.is_incremental ||
                            saved.is_centre_absolute != now.is_centre_absolute ||
                            saved.retracts_to_r != now.retracts_to_r;
  state_.is_incremental = saved.is_incremental;
  state_.is_centre_absolute = saved.is_centre_absolute;
  state_.retracts_to_r = saved.retracts_to_r;
  return new_plane || new_tool_offset || new_system || new_path || new_distance;
}

SavedLevel& Interpreter::Machine::saved_level() {
  saved_.resize(flow_.calls.size() + 1);
  return saved_.back();
}

void Interpreter::Machine::saved_modes() {
  const Request::Chosen& chosen = request().of(Group::m_spindle);
  if (chosen.code == nullptr) return;
  switch (chosen.code->tenths) {
    case 700:
    case 730:
      saved_level().modes = save_modal_state();
      saved_level().is_valid = true;
      if (chosen.code->tenths == 730) saved_level().restores_on_return = !flow_.calls.empty();
      return;
    case 710:
      saved_level().is_valid = false;
      return;
    case 720:
      return restore_saved_level(chosen.column);
    default:
      return;
  }
}

// Words next to an M72 that restores something are lost in LinuxCNC: the blocks that it runs
// take the place of this one.
void Interpreter::Machine::restore_saved_level(int column) {
  if (!saved_level().is_valid) {
    fail(column, "M72 requires a preceding M70 or M73 at this call level");
  }
  if (!restore_modal_state(saved_level().modes)) return;
  if (block_.words.size() > 1) {
    warn(column,
         "M72 restores the modal state: words in the same block that act later are ignored, as in "
         "LinuxCNC");
  }
  request_.clear();
}

void Interpreter::Machine::restore_on_return() {
  const auto left = flow_.calls.size() + 1;
  if (left >= saved_.size()) return;
  const SavedLevel saved = saved_[left];
  saved_.resize(left);
  if (saved.is_valid && saved.restores_on_return) restore_modal_state(saved.modes);
}

}  // namespace servomill::controllers
