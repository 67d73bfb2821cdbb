// G10, G28, G30, G52, G53, G92: origins, homes and shifts.
#include <fmt/format.h>

#include "controllers/gcode/interpreter_machine.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr std::string_view kUnknownHeight =
    "Z depends on the unknown tool length; pass a tool table with --tools";

}  // namespace

void Interpreter::Machine::non_modal() {
  if (state_.controls_tip()) refuse_while_tip_is_controlled();
  switch (request().code(Group::g_non_modal)) {
    case 100:
      return set_offsets();
    case 280:
      return go_home(parameter::kHome);
    case 281:
      return store_home(parameter::kHome);
    case 300:
      return go_home(parameter::kSecondHome);
    case 301:
      return store_home(parameter::kSecondHome);
    case 520:
    case 920:
      return shift_position(request().code(Group::g_non_modal) == 520);
    case 921:
      return drop_shift(true);
    case 922:
      return drop_shift(false);
    case 923:
      return restore_shift();
    case 531:
      return orient_tool();
    default:
      return;  // none, G4 (done), G53 (part of the motion)
  }
}

void Interpreter::Machine::set_offsets() {
  const int column = request().of(Group::g_non_modal).column;
  if (!request().has('L')) fail(column, "G10 requires an L word (L0 L1 L2 L10 L11 L20)");
  const int L = integer('L');
  if (L == 0) return reload_tools();
  if (L == 1 || L == 10 || L == 11) return set_tool(L);
  if (L != 2 && L != 20) {
    fail_at('L', fmt::format("G10 L{}; must be L0, L1, L2, L10, L11 or L20", L));
  }
  for (const char word : {'I', 'J', 'Q'}) {
    if (request().has(word))
      fail_at(word, fmt::format("{} word is not allowed with G10 L{}", word, L));
  }
  if (!request().has('P')) fail(column, fmt::format("G10 L{} requires a P word (0 ... 9)", L));
  const int P = integer('P');
  if (P < 0 || P > kWorkSystems) fail_at('P', fmt::format("G10 L{} P{}; must be in 0 ... 9", L, P));
  const int system = P == 0 ? state_.work_system : P;
  L == 2 ? set_work_offset(system) : set_current_position(system);
}

void Interpreter::Machine::set_work_offset(int system) {
  for (int i = 0; i < kAxisWords; ++i) {
    if (!has_axis(i)) continue;
    parameters_.set(parameter::work_offset(system) + i, in_parameter_unit(i, axis_word(i)));
  }
  if (request().has('R')) parameters_.set(parameter::work_rotation(system), request()['R']);
  refresh_if_active(system);
}

// The offset that makes the present position read as the words say.
void Interpreter::Machine::set_current_position(int system) {
  if (request().has('R'))
    fail_at('R', "R word is not allowed with G10 L20; only G10 L2 sets a rotation");
  if (state_.is_height_unknown && has_axis(2)) fail_at('Z', std::string(kUnknownHeight));
  ModalState other = state_;
  for (int i = 0; i < kAxisWords; ++i) {
    other.work_offset[i] =
        from_parameter_unit(i, parameters_.get(parameter::work_offset(system) + i));
  }
  other.set_rotation(parameters_.get(parameter::work_rotation(system)) * deg);
  AxisWords excess = AxisWords::Zero();
  const AxisWords present = other.from_account(state_.to_account(state_.position));
  for (int i = 0; i < kAxisWords; ++i) {
    if (has_axis(i)) excess[i] = present[i] - axis_word(i);
  }
  const AxisWords offset = other.work_offset + other.rotated(excess);
  for (int i = 0; i < kAxisWords; ++i) {
    parameters_.set(parameter::work_offset(system) + i, in_parameter_unit(i, offset[i]));
  }
  refresh_if_active(system);
}

// As LinuxCNC: the position is carried over as if there were no G92 offset. That makes a
// difference only if the rotation changes while there is one.
void Interpreter::Machine::refresh_if_active(int system) {
  if (system != state_.work_system) return;
  const AxisWords point = state_.rotated(state_.position) + state_.work_offset;
  load_work_system(system);
  state_.position = state_.unrotated(point - state_.work_offset);
}

void Interpreter::Machine::go_home(int first_parameter) {
  AxisWords target;
  for (int i = 0; i < kAxisWords; ++i) {
    target[i] = from_parameter_unit(i, parameters_.get(first_parameter + i));
  }
  const AxisWords home = state_.target_to_work(target);
  const bool some = has_any_axis();
  const AxisWords via = programmed_end();  // without axis words: where it stands
  note_height();
  move_to(MoveKind::rapid, via, (via - state_.position).head<3>().norm(), 0.0);
  AxisWords end = state_.position;
  for (int i = 0; i < kAxisWords; ++i) {
    if (!some || has_axis(i)) end[i] = home[i];
  }
  if (!some || has_axis(2)) state_.is_height_unknown = state_.is_length_unknown;
  move_to(MoveKind::rapid, end, (end - state_.position).head<3>().norm(), 0.0);
}

void Interpreter::Machine::store_home(int first_parameter) {
  const AxisWords machine = state_.to_account(state_.position);
  for (int i = 0; i < kAxisWords; ++i) {
    parameters_.set(first_parameter + i, in_parameter_unit(i, machine[i]));
  }
}

void Interpreter::Machine::store_shift() {
  for (int i = 0; i < kAxisWords; ++i) {
    parameters_.set(parameter::kG92 + i, in_parameter_unit(i, state_.shift[i]));
  }
  parameters_.set(parameter::kG92Active, 1.0);
}

void Interpreter::Machine::shift_position(bool is_g52) {
  if (!has_any_axis()) {
    fail(request().of(Group::g_non_modal).column,
         fmt::format("{} requires an axis word", is_g52 ? "G52" : "G92"));
  }
  if (state_.is_height_unknown && has_axis(2)) fail_at('Z', std::string(kUnknownHeight));
  for (int i = 0; i < kAxisWords; ++i) {
    if (!has_axis(i)) continue;
    const double sum = state_.position[i] + state_.shift[i];
    if (is_g52) {
      state_.shift[i] = axis_word(i);
      state_.position[i] = sum - state_.shift[i];
    } else {
      state_.position[i] = axis_word(i);
      state_.shift[i] = sum - state_.position[i];
    }
  }
  store_shift();
}

void Interpreter::Machine::drop_shift(bool forget) {
  state_.position += state_.shift;
  state_.shift.setZero();
  if (forget) store_shift();
  parameters_.set(parameter::kG92Active, 0.0);
}

void Interpreter::Machine::restore_shift() {
  state_.position += state_.shift;
  for (int i = 0; i < kAxisWords; ++i) {
    state_.shift[i] = from_parameter_unit(i, parameters_.get(parameter::kG92 + i));
  }
  state_.position -= state_.shift;
  parameters_.set(parameter::kG92Active, 1.0);
}

}  // namespace servomill::controllers
