#include "heidenhain_examples.h"

#include <fmt/format.h>

#include <sstream>

#include "action_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

double unit_of(int axis) { return axis < 3 ? mm : deg; }

std::string axes(const MachineAction& action) {
  std::string text;
  for (int axis = 0; axis < kAxisWords; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const bool is_commanded = action.is_commanded[i];
    if (axis >= 3 && !is_commanded && !action.end[i]) continue;
    const std::string value = action.end[i] ? plain_number(*action.end[i] / unit_of(axis)) : "?";
    const std::string word = letter(kAllAxes[i]) + value;
    text += is_commanded ? " " + word : " (" + word + ")";
  }
  return text;
}

std::string feed(const MachineAction& action) {
  bool is_linear = false;
  for (std::size_t i = 0; i < 3; ++i) is_linear = is_linear || action.is_commanded[i];
  switch (action.feed_mode) {
    case FeedMode::units_per_minute:
      return " F" + plain_number(action.feed / (is_linear ? mm_per_min : deg_per_min));
    case FeedMode::inverse_time:
      return " T" + plain_number(1.0 / action.feed);
    case FeedMode::units_per_revolution:
      return " R" + plain_number(action.feed / mm);
  }
  return "";
}

std::string path_mode(const MachineAction& action) {
  if (!action.is_path_mode_known) return "";
  return action.path_tolerance ? " tolerance " + plain_number(*action.path_tolerance / mm)
                               : " tolerance of the machine";
}

std::string centre(const MachineAction& action) {
  std::string text = " about";
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == action.normal_axis) continue;
    text += fmt::format(" {}{}", letter(kAllAxes[static_cast<std::size_t>(axis)]),
                        plain_number(action.centre[axis] / mm));
  }
  return text + fmt::format(" turns {}", action.turns);
}

std::string described(const MachineAction& action) {
  const std::string where = action.is_to_reference       ? " limit"
                            : action.is_machine_position ? " M91"
                                                         : "";
  switch (action.kind) {
    case ActionKind::rapid:
      return "rapid" + where + (action.is_straight ? "" : " bent") + axes(action) +
             path_mode(action);
    case ActionKind::feed:
      return "feed" + where + axes(action) + feed(action) + path_mode(action);
    case ActionKind::arc:
      return "arc" + axes(action) + centre(action) + feed(action) + path_mode(action);
    case ActionKind::dwell:
      return "dwell " + plain_number(action.value);
    case ActionKind::tool:
      return fmt::format("tool {}", action.number);
    case ActionKind::spindle:
      return fmt::format("spindle {} S{}", action.direction, plain_number(action.value / rpm));
    case ActionKind::coolant:
      return fmt::format("coolant {}", action.number);
    case ActionKind::stop:
      return fmt::format("stop {}", action.number);
    case ActionKind::end:
      return fmt::format("end {}", action.number);
    case ActionKind::probe:
      return fmt::format("probe {}", action.direction > 0 ? "+" : "-") + axes(action);
  }
  return "";
}

}  // namespace

ControlSetup heidenhain_example_setup() {
  ControlSetup setup;
  const auto at = [](double x, double y, double z) {
    AxisWords words = AxisWords::Zero();
    words.head<3>() << x * mm, y * mm, z * mm;
    return words;
  };
  setup.work_offset[0] = at(200, 250, -100);
  setup.work_offset[1] = at(300, 100, -50);
  setup.work_offset[2] = at(10, 20, 30);
  setup.work_rotation[2] = 90.0 * deg;
  setup.tool_length = {{1, 50.0 * mm}, {2, 80.0 * mm}};
  return setup;
}

std::string heidenhain_program(const std::string& lines) {
  const std::string frame =
      "BEGIN PGM T MM\nTRANS DATUM RESET\nCYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1\n"
      "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+0\nCYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 1\n"
      "CYCL DEF 26.0 AXIS-SPECIFIC SCALING\nCYCL DEF 26.1 X 1 Y 1 Z 1\n"
      "TOOL CALL 1 Z S1000\nL M137\nL X+0 Y+0 R0 FMAX\n";
  std::istringstream text(frame + lines + "L M30\nEND PGM T MM\n");
  std::string program;
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    const bool is_continuation = line.front() == ' ';
    program += is_continuation ? line : fmt::format("{} {}", number++, line);
    program += '\n';
  }
  return program;
}

std::string describe(const std::vector<MachineAction>& actions, int frame_lines) {
  std::string text;
  for (const MachineAction& action : actions) {
    if (action.line <= frame_lines) continue;
    if (frame_lines > 0 && action.kind == ActionKind::end) continue;
    text += fmt::format("{} {}\n", action.line - frame_lines, described(action));
  }
  return text;
}

}  // namespace servomill::controllers
