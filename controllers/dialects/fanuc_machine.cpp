#include "controllers/dialects/fanuc_machine.h"

#include <fmt/format.h>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

FanucMachine::FanucMachine(const std::string& file, const ControlSetup& setup,
                           const FanucSettings& settings, const FanucRules& rules)
    : file_(file), setup_(setup), settings_(settings), rules_(rules), position_(setup.start) {
  take_absent_functions();
  if (rules.modes_are_unknown_at_start) return;
  // a wrong rule: the state that the manuals give for power-on
  modes_ = {.motion = 0,
            .normal_axis = 2,
            .is_incremental = false,
            .feed_mode = FeedMode::units_per_minute,
            .unit = mm,
            .work_system = 1,
            .path = PathMode::continuous,
            .is_cutter_off = true,
            .is_cycle_off = true,
            .is_scaling_off = true,
            .is_rotation_off = true,
            .is_polar_off = true,
            .is_surface_speed_off = true};
  modes_.is_mirror_off.fill(true);
  modes_.is_local_off.fill(true);
  modes_.is_shift_off.fill(true);
  length_ = {FanucLength::Mode::off, 1.0, 0, 0.0, false};
}

// A function that the control does not have cannot be active.
void FanucMachine::take_absent_functions() {
  modes_.is_polar_off = !settings_.has_polar;
  modes_.is_scaling_off = !settings_.has_scaling;
  modes_.is_surface_speed_off = !settings_.has_surface_speed;
  modes_.is_mirror_off.fill(!settings_.has_mirror);
  modes_.is_shift_off.fill(!settings_.has_preset);
}

void FanucMachine::fail(int column, const std::string& message) const {
  throw InputError({file_, block_ == nullptr ? 0 : block_->line, column}, message);
}

bool FanucMachine::run(const FanucBlock& block) {
  block_ = &block;
  read_codes();
  set_modes();
  check_words();
  if (is_switch()) {
    run_switch();
    return true;
  }
  set_feed();
  set_spindle();
  if (const FanucWord* T = word('T')) {
    selected_ = integer('T', 99999999);
    if (names_axis())
      fail(T->column, "T and a motion in one block: their order is defined by the machine builder");
  }
  if (M_.tenths >= 0) {
    if (names_axis() || code(Group::one_shot) == 40) {
      fail(M_.column,
           "M and a motion or dwell in one block: their order is defined by the machine builder");
    }
    set_length();
    run_M();
    return M_.tenths != 2 && M_.tenths != 30;
  }
  if (code(Group::one_shot) == 40) {
    run_dwell();
    return true;
  }
  set_length();
  const int one_shot = code(Group::one_shot);
  if (one_shot == 530 || (is_modal_machine_ && names_axis())) {
    run_machine_position();
  } else if (one_shot == 280 || one_shot == 300) {
    run_reference_return();
  } else if (one_shot == 310) {
    run_skip();
  } else if (names_axis() || has_centre()) {
    run_motion();
  }
  return true;
}

void FanucMachine::run_M() {
  switch (M_.tenths) {
    case 3:
    case 4:
    case 5:
      return run_spindle(M_.tenths);
    case 6:
      return change_tool();
    case 7:
    case 8:
    case 9:
      return run_coolant(M_.tenths);
    default: {
      const bool is_end = M_.tenths == 2 || M_.tenths == 30;
      MachineAction out = action(is_end ? ActionKind::end : ActionKind::stop);
      out.number = M_.tenths;
      if (!is_end && rules_.stop_forgets_positions) forget_positions();
      out.end = position_;
      actions_.push_back(out);
    }
  }
}

void FanucMachine::run_spindle(int M) {
  if (M != 5 && !speed_) fail(M_.column, fmt::format("M{} requires a known S", M));
  direction_ = M == 3 ? 1 : M == 5 ? 0 : rules_.M4_is_counter_clockwise ? -1 : 1;
  MachineAction out = action(ActionKind::spindle);
  out.direction = *direction_;
  out.value = speed_.value_or(0.0);
  actions_.push_back(out);
}

void FanucMachine::run_coolant(int M) {
  constexpr int kMist = 1, kFlood = 2;
  if (M == 7) coolant_ |= kMist;
  if (M == 8) coolant_ |= kFlood;
  if (M == 9) coolant_ = rules_.M9_stops_mist_and_flood ? 0 : coolant_ & ~kFlood;
  MachineAction out = action(ActionKind::coolant);
  out.number = coolant_;
  actions_.push_back(out);
}

void FanucMachine::forget_positions() { position_ = {}; }

// A macro of the machine builder moves axes and changes modes. The unit, rotation, scaling, mirror
// images and shifts are taken to stay: no source was found for a macro that changes them.
void FanucMachine::change_tool() {
  if (!selected_) fail(M_.column, "M6 requires a known T");
  tool_ = selected_;
  if (rules_.tool_change_forgets_positions) forget_positions();
  if (rules_.tool_change_forgets_modes) {
    FanucModes modes;
    modes.unit = modes_.unit;
    modes.is_scaling_off = modes_.is_scaling_off;
    modes.is_rotation_off = modes_.is_rotation_off;
    modes.is_polar_off = modes_.is_polar_off;
    modes.is_surface_speed_off = modes_.is_surface_speed_off;
    modes.is_mirror_off = modes_.is_mirror_off;
    modes.is_local_off = modes_.is_local_off;
    modes.is_shift_off = modes_.is_shift_off;
    modes_ = modes;
    length_ = {};
    feed_.reset();
  }
  if (rules_.tool_change_forgets_spindle) {
    speed_.reset();
    direction_.reset();
    coolant_ = 0;
  }
  MachineAction out = action(ActionKind::tool);
  out.number = *tool_;
  out.end = position_;
  actions_.push_back(out);
}

MachineAction FanucMachine::action(ActionKind kind) const {
  MachineAction out;
  out.kind = kind;
  out.line = block_->line;
  out.end = position_;
  out.tool = tool_.value_or(0);
  const bool has_length = length_.mode == FanucLength::Mode::on && !length_.is_suspended;
  out.tool_offset = has_length ? *length_.number : 0;
  const bool stops = code(Group::one_shot) == 90 || is_modal_exact_stop_;
  out.is_path_mode_known = modes_.path.has_value() || stops;
  out.path_mode = stops ? PathMode::exact_stop : modes_.path.value_or(PathMode::continuous);
  return out;
}

void FanucMachine::move_to(MachineAction action) {
  for (std::size_t i = 0; i < action.end.size(); ++i) {
    if (action.is_commanded[i]) position_[i] = action.end[i];
  }
  action.end = position_;
  actions_.push_back(action);
}

}  // namespace servomill::controllers
