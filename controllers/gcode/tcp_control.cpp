// Tool-centre-point control and tilted work planes: G43.4 G43.5 G53.1 G68.2 G69.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "controllers/gcode/interpreter_machine.h"
#include "plant/vocabulary/tool_axis.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kMinVector = 1e-6;  // length of a tool axis; below it is zero
constexpr double kLeaning = 1e-4;    // rad of the tool axis off Z of a tilted plane

constexpr bool is_of_five_axes(int tenths) {
  return tenths == 434 || tenths == kVectorControl || tenths == 531 || tenths == 682 ||
         tenths == 690;
}

}  // namespace

void Interpreter::Machine::refuse_codes_beyond_linuxcnc() const {
  if (setup_.reader != Reader::linuxcnc || setup_.takes_five_axis_codes) return;
  for (const Group group : {Group::g_tool_length, Group::g_non_modal, Group::g_work_plane}) {
    const Request::Chosen& chosen = request().of(group);
    if (chosen.code == nullptr || !is_of_five_axes(chosen.code->tenths)) continue;
    fail(chosen.column,
         fmt::format("{} is not supported by linuxcnc", code_name('G', chosen.code->tenths)));
  }
}

// Tool length compensation that the codes of the group of G43 leave in force.
ToolControl Interpreter::Machine::tool_control_of(int code) const {
  if (code != 434 && code != kVectorControl) return ToolControl::none;
  const int column = request().of(Group::g_tool_length).column;
  if (setup_.machine && setup_.machine->number_of_rotary_axes() == 0) {
    fail(column, fmt::format("{}: the machine has no rotary axis{}", code_name('G', code),
                             code == kVectorControl ? "" : "; write G43 H"));
  }
  if (code == 434) return ToolControl::rotary_axes;
  if (!setup_.machine && !setup_.accepts_unknown_positions) {
    fail(column, "G43.5: the rotary axis positions depend on the machine; pass it with --machine");
  }
  return ToolControl::tool_axis;
}

// Without a known machine, tip and axes differ by the tool as long as nothing is rotated.
std::string Interpreter::Machine::rotary_not_at_zero(const AxisWords& machine) const {
  for (int i = kLinearJoints; i < kAxisWords; ++i) {
    if (machine[i] == 0.0) continue;
    return fmt::format(
        "{} is at {:g} deg: the TCP position depends on the machine; pass it with --machine",
        letter(axis_at(i)), machine[i] / deg);
  }
  return {};
}

void Interpreter::Machine::require_rotary_at_zero(const AxisWords& machine, int column) {
  const std::string why = rotary_not_at_zero(machine);
  if (why.empty()) return;
  if (!setup_.accepts_unknown_positions) fail(column, why);
  note_without_machine(column, why + " (--machine)");
}

// Once in a program.
void Interpreter::Machine::note_without_machine(int column, const std::string& why) {
  if (noted_.insert(why).second) warn(column, why);
}

// Positions of the axes, also while the tip is controlled.
AxisWords Interpreter::Machine::machine_now(int column) const {
  const AxisWords account = state_.to_account(state_.position);
  if (!state_.controls_tip()) return account;
  if (setup_.machine) {
    const auto machine = setup_.machine->machine_words(account, state_.p_ST());
    if (!machine) fail(column, "the linear axes cannot reach the current TCP position");
    return *machine;
  }
  const std::string why = rotary_not_at_zero(account);
  if (!why.empty() && !setup_.accepts_unknown_positions) fail(column, why);
  AxisWords machine = account;
  machine.head<3>() -= state_.p_ST();
  return machine;
}

void Interpreter::Machine::stand_at(const AxisWords& machine, int column) {
  state_.compensation.left_at.reset();
  if (!state_.controls_tip()) {
    state_.position = state_.from_account(machine);
    return;
  }
  AxisWords tip = machine;
  if (setup_.machine) {
    tip = setup_.machine->tip_words(machine, state_.p_ST());
  } else {
    require_rotary_at_zero(machine, column);
    tip.head<3>() += state_.p_ST();
  }
  state_.position = state_.from_account(tip);
}

void Interpreter::Machine::work_plane() {
  const int code = request().code(Group::g_work_plane);
  if (code < 0) return;
  const int column = request().of(Group::g_work_plane).column;
  if (code == 690) {
    if (!state_.plane) return;
    const AxisWords machine = machine_now(column);
    state_.plane.reset();
    stand_at(machine, column);
    return;
  }
  if (state_.plane) fail(column, "G68.2 is not allowed in a tilted work plane; program G69 first");
  if (state_.tool_offset_number == kOtherToolOffset) {
    fail(column, "G68.2 is not supported with a tool offset of G43.1 or G43.2; use G43 H");
  }
  refuse_rotary_words();
  const AxisWords machine = machine_now(column);
  WorkPlane plane;
  for (int i = 0; i < kLinearJoints; ++i) {
    if (has_axis(i)) plane.origin[i] = axis_word(i);
  }
  const auto turn = [&](char letter, const Eigen::Vector3d& about) {
    return Eigen::AngleAxisd(request()[letter] * deg, about).toRotationMatrix();
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  plane.R = turn('I', z) * turn('J', x) * turn('K', z);
  state_.plane = std::make_shared<const WorkPlane>(plane);
  if (unknowns_.tilt) cut_plane_ = state_.plane;
  stand_at(machine, column);
}

void Interpreter::Machine::orient_tool() {
  const int column = request().of(Group::g_non_modal).column;
  if (!state_.plane) fail(column, "G53.1 requires a tilted work plane; program G68.2 first");
  if (request().motion.code != nullptr) {
    fail(request().motion.column, "G53.1 must be in a block without motion");
  }
  if (!setup_.machine) {
    const std::string why =
        "G53.1: the rotary axis positions depend on the machine; pass it with --machine";
    if (!setup_.accepts_unknown_positions) fail(column, why);
    cut_plane_ = state_.plane;  // the tool is normal to it, although no axis is known to turn
    return note_without_machine(column, why);
  }
  if (setup_.machine->number_of_rotary_axes() == 0) {
    fail(column, "G53.1: the machine has no rotary axis");
  }
  const AxisWords machine = machine_now(column);
  const JointLayout& layout = setup_.machine->chain().layout;
  const auto found = setup_.machine->point(state_.direction_in_workpiece(Eigen::Vector3d::UnitZ()),
                                           layout.joints(machine));
  if (!found.fault.empty()) fail(column, fmt::format("G53.1: {}", found.fault));
  AxisWords turned = machine;
  const AxisWords words = layout.words(found.Q);
  for (int i = kLinearJoints; i < kAxisWords; ++i) {
    if (layout.joint_of(axis_at(i))) turned[i] = words[i];
  }
  stand_at(turned, column);
  if (state_.tool_control == ToolControl::tool_axis) {
    state_.tool_axis = setup_.machine->tool_axis(found.Q);
  }
  Move& move = emit(MoveKind::rapid);
  move.tool_control = ToolControl::none;
  move.end_machine = turned;
}

// Codes whose words, or whose account of the position, are those of the axes.
void Interpreter::Machine::refuse_while_tip_is_controlled() const {
  const Request::Chosen& chosen = request().of(Group::g_non_modal);
  if (chosen.code == nullptr) return;
  const int code = chosen.code->tenths;
  if (code == 40 || code == 531) return;
  const bool speaks_of_axes =
      code == 530 || code == 280 || code == 281 || code == 300 || code == 301;
  if (state_.plane) {
    fail(chosen.column, fmt::format("{} is not allowed in a tilted work plane; program G69 first",
                                    code_name('G', code)));
  }
  if (state_.tool_control != ToolControl::none && speaks_of_axes) {
    fail(chosen.column, fmt::format("{} is not allowed under TCP control; program G49 first",
                                    code_name('G', code)));
  }
}

void Interpreter::Machine::refuse_rotary_words() const {
  const bool has_vectors = state_.tool_control == ToolControl::tool_axis;
  for (int i = kLinearJoints; i < kAxisWords; ++i) {
    if (!has_axis(i)) continue;
    const char name = letter(axis_at(i));
    if (has_vectors) {
      fail_at(name,
              fmt::format("{} word is not allowed with G43.5; I J K define the tool axis", name));
    }
    if (state_.plane && state_.tool_control == ToolControl::none) {
      fail_at(name, fmt::format("{} word is not allowed in a tilted work plane; orient the tool "
                                "with G53.1, or use G43.4 for rotary axes",
                                name));
    }
    if (request().code(Group::g_work_plane) == 682) {
      fail_at(name, fmt::format("{} word is not allowed with G68.2; its angles are I J K", name));
    }
  }
}

bool Interpreter::Machine::has_vector() const {
  return state_.tool_control == ToolControl::tool_axis &&
         (request_.has('I') || request_.has('J') || request_.has('K'));
}

// The tool axis of a block under G43.5, in W.
Eigen::Vector3d Interpreter::Machine::programmed_axis() {
  if (!has_vector()) {
    if (state_.tool_axis.isZero(0.0)) {
      fail(request().motion.column, "G43.5 requires I J K in its first move");
    }
    return state_.tool_axis;
  }
  const Eigen::Vector3d given(request()['I'], request()['J'], request()['K']);
  const char first = request().has('I') ? 'I' : request().has('J') ? 'J' : 'K';
  const double length = given.norm();
  if (!(length > kMinVector)) fail_at(first, "the tool axis I J K has length zero");
  if (std::abs(length - 1.0) > kAxisLengthTolerance) {
    warn(request().word(first).column,
         fmt::format("the tool axis I J K has length {:.6g}; normalised to a unit vector", length));
  }
  return (state_.direction_in_workpiece(given) / length).normalized();
}

// Puts the rotary words of `end` to where the tool axis is k. Returns the angle of the turn, rad.
double Interpreter::Machine::turn_towards(const Eigen::Vector3d& k, AxisWords& end) const {
  if (!setup_.machine) {
    return state_.tool_axis.isZero(0.0) ? 0.0 : angle_between(state_.tool_axis, k);
  }
  const JointLayout& layout = setup_.machine->chain().layout;
  const AxisWords now = state_.to_machine(state_.position);
  const AxisTurn turn = setup_.machine->great_circle(layout.joints(now), k);
  if (!turn.fault.empty()) fail(request().motion.column, turn.fault);
  const AxisWords words = layout.words(turn.knots.back().Q);
  for (int i = kLinearJoints; i < kAxisWords; ++i) {
    if (layout.joint_of(axis_at(i))) end[i] = state_.position[i] + (words[i] - now[i]);
  }
  return turn.angle;
}

// Once for each tilted plane in which it cuts, and whose tilt is known.
void Interpreter::Machine::warn_of_leaning_tool() {
  if (!state_.plane || state_.tool_control != ToolControl::none || cut_plane_ == state_.plane)
    return;
  cut_plane_ = state_.plane;
  const AxisWords now = state_.to_machine(state_.position);
  Eigen::Vector3d k = Eigen::Vector3d::UnitZ();  // with nothing turned
  if (setup_.machine) {
    k = setup_.machine->tool_axis(setup_.machine->chain().layout.joints(now));
  } else if (!rotary_not_at_zero(now).empty()) {
    return;
  }
  const double angle = angle_between(k, state_.direction_in_workpiece(Eigen::Vector3d::UnitZ()));
  if (angle < kLeaning) return;
  const bool can_turn = !setup_.machine || setup_.machine->number_of_rotary_axes() > 0;
  warn(request().motion.column,
       fmt::format("the tool axis is {:.4f} deg off Z of the tilted work plane{}", angle / deg,
                   can_turn ? "; G53.1 aligns it" : ""));
}

}  // namespace servomill::controllers
