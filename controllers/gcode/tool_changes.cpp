// G10 L0 L1 L10 L11: the tool table while a program runs.
#include <fmt/format.h>

#include <array>

#include "controllers/gcode/interpreter_machine.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr int kFixture = 9;  // G59.3, to which G10 L11 refers
constexpr int kMaxOrientation = 9;

}  // namespace

void Interpreter::Machine::reload_tools() {
  if (state_.tool != 0) {
    fail_at('L', fmt::format("G10 L0 with tool T{} in the spindle; unload it (T0 M6) first",
                             state_.tool));
  }
  setup_.tools = tools_at_start_;
}

// Position of the tool, without its offset, in a work system. G92 is left out of the fixture's.
AxisWords Interpreter::Machine::position_for_tool(int system) const {
  ModalState other = state_;
  other.tool_account.setZero();
  other.shift.setZero();
  for (int i = 0; i < kAxisWords; ++i) {
    const double unit = is_linear(axis_at(i)) ? mm : deg;
    other.work_offset[i] = parameters_.get(parameter::work_offset(system) + i) * unit;
    if (system != kFixture && parameters_.get(parameter::kG92Active) != 0.0) {
      other.shift[i] = parameters_.get(parameter::kG92 + i) * unit;
    }
  }
  other.set_rotation(parameters_.get(parameter::work_rotation(system)) * deg);
  return other.from_account(state_.to_account(state_.position));
}

// The offset with which the present position would read as the words say (L10: in the work system
// in force, L11: in G59.3). X and Y turn with the work system; what only one of them leaves open is
// kept across it.
AxisWords Interpreter::Machine::offset_from_position(const AxisWords& old, int L) const {
  const int system = L == 11 ? kFixture : state_.work_system;
  const AxisWords position = position_for_tool(system);
  ModalState frame;
  frame.set_rotation(parameters_.get(parameter::work_rotation(system)) * deg);
  AxisWords out = old;
  AxisWords along = frame.unrotated(old);
  for (int i = 0; i < kAxisWords; ++i) {
    if (has_axis(i)) out[i] = along[i] = position[i] - axis_word(i);
  }
  if (has_axis(0) || has_axis(1)) out.head<2>() = frame.rotated(along).head<2>();
  return out;
}

void Interpreter::Machine::set_tool(int L) {
  const int column = request().of(Group::g_non_modal).column;
  if (!request().has('P')) fail(column, fmt::format("G10 L{} requires a P word (tool number)", L));
  const int number = integer('P');
  if (number < 1) fail_at('P', fmt::format("G10 L{} P{}; must be a tool number >= 1", L, number));
  ToolEntry tool = tool_named('P', number);
  const bool sets_more =
      request().has('R') || request().has('I') || request().has('J') || request().has('Q');
  if (!has_any_axis() && !sets_more) {
    fail(column, fmt::format("G10 L{} requires a word to set (X Y Z A B C R I J Q)", L));
  }
  for (int i = 0; i < kAxisWords && L == 1; ++i) {
    if (has_axis(i)) tool.offset[i] = axis_word(i);
  }
  if (L != 1) tool.offset = offset_from_position(tool.offset, L);
  if (request().has('R')) tool.diameter = 2.0 * request()['R'] * state_.unit;
  if (request().has('I')) tool.front_angle = request()['I'] * deg;
  if (request().has('J')) tool.back_angle = request()['J'] * deg;
  if (request().has('Q')) {
    tool.orientation = integer('Q');
    if (tool.orientation < 0 || tool.orientation > kMaxOrientation) {
      fail_at('Q', fmt::format("Q{}; the tool orientation must be in 0 ... {}", tool.orientation,
                               kMaxOrientation));
    }
  }
  setup_.tools.replace(tool);
}

}  // namespace servomill::controllers
