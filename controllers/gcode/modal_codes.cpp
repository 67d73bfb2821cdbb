// Dwell, plane, unit, tool length, work system, path control, distance modes, stops.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "controllers/gcode/interpreter_machine.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

void Interpreter::Machine::dwell() {
  if (request().code(Group::g_non_modal) != 40) return;
  const int column = request().of(Group::g_non_modal).column;
  if (!request().has('P')) fail(column, "G4 requires a P word (seconds)");
  const double P = request()['P'];
  if (P < 0.0) fail_at('P', fmt::format("G4 P{}; must be >= 0", P));
  const int motion_code = request().code(Group::g_motion);
  if (motion_code == 20 || motion_code == 30) {
    fail(column, "G4 and an arc are not allowed in one block: both use the P word");
  }
  emit(MoveKind::dwell).value = has_unknown_dwell() ? kUnknownValue : P;
}

void Interpreter::Machine::plane() {
  const int code = request().code(Group::g_plane);
  if (code < 0) return;
  state_.normal_axis = code < 180 ? 2 : code < 190 ? 1 : 0;
  state_.is_uvw_plane = code % 10 != 0;
}

void Interpreter::Machine::units() {
  const int code = request().code(Group::g_units);
  if (code < 0) return;
  state_.set_unit(code == 200 ? inch : mm);
  noted_.insert("unit");
}

void Interpreter::Machine::tool_length() {
  const int code = request().code(Group::g_tool_length);
  if (code < 0) return;
  const int column = request().of(Group::g_tool_length).column;
  const AxisWords machine = machine_now(column);
  state_.is_length_unknown = false;
  if (code == 490) {
    state_.set_tool_offset(AxisWords::Zero());
    state_.tool_offset_number = 0;
  } else if (code == 431) {
    AxisWords offset = state_.tool_account;
    for (int i = 0; i < kAxisWords; ++i) {
      if (has_axis(i)) offset[i] = axis_word(i);
    }
    state_.set_tool_offset(offset);
    state_.tool_offset_number = kOtherToolOffset;
  } else {
    set_table_offset(code == 432);
  }
  const ToolControl before = std::exchange(state_.tool_control, tool_control_of(code));
  if (before != state_.tool_control) state_.tool_axis.setZero();
  const ToolEntry* at_start = tools_at_start_.find(state_.tool_offset_number);
  if (state_.controls_tip() && at_start != nullptr &&
      at_start->offset != tool_named('H', state_.tool_offset_number).offset) {
    fail(column, fmt::format("{}: G10 has changed T{}; TCP control and tilted planes require the "
                             "offset of the tool table",
                             code_name('G', code), state_.tool_offset_number));
  }
  if (state_.plane && state_.tool_offset_number == kOtherToolOffset) {
    fail(column, fmt::format("{} is not supported in a tilted work plane; use G43 H",
                             code_name('G', code)));
  }
  const bool is_same = state_.is_length_unknown && before_.is_length_unknown &&
                       state_.tool_offset_number == before_.tool_offset_number;
  const bool is_unknown = state_.is_length_unknown || before_.is_length_unknown;
  if (is_unknown && !is_same) state_.is_height_unknown = true;
  stand_at(machine, column);
}

// A tool of unknown length: work coordinates are as programmed, machine coordinates unknown.
bool Interpreter::Machine::is_unknown_length(bool is_added, int number, int column) {
  const bool may_be = setup_.accepts_unknown_lengths && setup_.tools.empty() && number != 0 &&
                      !is_added && !state_.controls_tip() &&
                      request().code(Group::g_tool_length) == 430;
  return may_be && tolerates(ReaderRule::unknown_length, column);
}

// G43 and G43.2
void Interpreter::Machine::set_table_offset(bool is_added) {
  const bool has_H = request().has('H');
  if (is_added && !has_H)
    fail(request().of(Group::g_tool_length).column, "G43.2 requires an H word");
  int number = has_H ? integer('H') : state_.tool;
  if (number == 0) number = state_.tool;
  if (is_unknown_length(is_added, number, request().of(Group::g_tool_length).column)) {
    state_.set_tool_offset(AxisWords::Zero());
    state_.tool_offset_number = number;
    state_.is_length_unknown = true;
    return;
  }
  const AxisWords& offset = tool_named(has_H ? 'H' : 'T', number).offset;
  state_.set_tool_offset(is_added ? AxisWords(state_.tool_account + offset) : offset);
  state_.tool_offset_number = is_added ? kOtherToolOffset : number;
}

void Interpreter::Machine::load_work_system(int system) {
  const AxisWords machine = state_.to_account(state_.position);
  state_.work_system = system;
  for (int i = 0; i < kAxisWords; ++i) {
    state_.work_offset[i] =
        from_parameter_unit(i, parameters_.get(parameter::work_offset(system) + i));
  }
  state_.set_rotation(parameters_.get(parameter::work_rotation(system)) * deg);
  parameters_.set(parameter::kWorkSystem, system);
  state_.position = state_.from_account(machine);
}

void Interpreter::Machine::work_system() {
  const int code = request().code(Group::g_work_system);
  if (code < 0) return;
  const int system = code <= 590 ? (code - 530) / 10 : 6 + code - 590;
  if (system != state_.work_system) load_work_system(system);
}

void Interpreter::Machine::path_control() {
  const int code = request().code(Group::g_path_control);
  if (code < 0) return;
  state_.path_mode = code == 610   ? PathMode::exact_path
                     : code == 611 ? PathMode::exact_stop
                                   : PathMode::continuous;
  state_.path_tolerance = 0.0;
  if (code != 640) return;
  for (const char word : {'P', 'Q'}) {
    const double value = request()[word];
    if (value < 0.0) {
      warn(request().word(word).column, fmt::format("G64 {}{} is treated as 0", word, value));
    }
  }
  state_.path_tolerance = std::max(request()['P'], 0.0) * state_.unit;
}

void Interpreter::Machine::distance() {
  const int code = request().code(Group::g_distance);
  if (code >= 0) state_.is_incremental = code == 910;
  const int arc_code = request().code(Group::g_arc_distance);
  if (arc_code >= 0) state_.is_centre_absolute = arc_code == 901;
  const int retract_code = request().code(Group::g_retract);
  if (retract_code >= 0) state_.retracts_to_r = retract_code == 990;
}

void Interpreter::Machine::stop() {
  const int code = request().code(Group::m_stop);
  if (code < 0) return;
  if (code == 990 && !flow_.calls.empty()) {
    fail(request().of(Group::m_stop).column, "M99 of a subprogram must be in a separate block");
  }
  if (code == 990 && setup_.reader != Reader::linuxcnc) {
    warn(request().of(Group::m_stop).column,
         "M99 in a main program: treated as program end; a control repeats the program endlessly");
  }
  if (code == 20 || code == 300 || code == 990) {
    refuse_inside_nurbs(request().of(Group::m_stop).column, code_name('M', code));
  }
  end_queue_at(state_.in_plane(state_.position));
  state_.compensation.begin.reset();
  if (code == 0 || code == 10 || code == 600) {
    emit(MoveKind::stop).number = code / 10;
    return;
  }
  if (state_.spindle_direction != 0) {
    state_.spindle_direction = 0;
    emit_spindle();
  }
  if (state_.coolant != 0) {
    state_.coolant = 0;
    emit(MoveKind::coolant).number = 0;
  }
  emit(MoveKind::end);
  ended_ = true;
}

}  // namespace servomill::controllers
