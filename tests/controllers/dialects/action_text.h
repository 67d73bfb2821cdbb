/// Actions of a machine as text, one a line, for examples worked out by hand.
///
///     4 rapid X210 Y270 Z?     the line; the kind; every axis that is commanded or known, in mm
///                              and deg of the machine; '?' where a commanded axis is unknown
///
/// Axes that are not commanded but known come in brackets. Further words: `~` each axis of a rapid
/// at its own rate, `machine` and `home` places of the machine, `F` in mm/min, deg/min, `1/min` or
/// `/rev`, arcs with normal, centre and turns, `H` the number of the length, `P` the tolerance of
/// corners in mm.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "controllers/dialects/machine_action.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

// The number with at most five decimals and without -0.
inline std::string plain_number(double value) {
  std::string text = fmt::format("{:.5f}", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

inline std::string axes_text(const MachineAction& action) {
  std::string out;
  for (const Axis axis : kAllAxes) {
    const auto i = static_cast<std::size_t>(index_of(axis));
    const auto& end = action.end[i];
    if (!action.is_commanded[i] && !end) continue;
    const double unit = is_linear(axis) ? mm : deg;
    const std::string word =
        fmt::format("{}{}", letter(axis), end ? plain_number(*end / unit) : "?");
    out += action.is_commanded[i] ? " " + word : fmt::format(" ({})", word);
  }
  return out;
}

inline std::string feed_text(const MachineAction& action) {
  const bool is_linear_feed = action.kind == ActionKind::arc || action.is_commanded[0] ||
                              action.is_commanded[1] || action.is_commanded[2];
  const double unit = is_linear_feed ? mm : deg;
  if (action.feed_mode == FeedMode::inverse_time) {
    return fmt::format(" F{}1/min", plain_number(action.feed * minute));
  }
  if (action.feed_mode == FeedMode::units_per_revolution) {
    return fmt::format(" F{}/rev", plain_number(action.feed / unit));
  }
  return " F" + plain_number(action.feed / unit * minute);
}

inline std::string motion_text(const MachineAction& action) {
  constexpr const char* kKinds[] = {"rapid", "feed", "arc"};
  const bool is_probe = action.kind == ActionKind::probe;
  std::string out =
      (is_probe ? "probe" : kKinds[static_cast<int>(action.kind)]) + axes_text(action);
  if (!action.is_straight) out += " ~";
  if (action.is_machine_position) out += action.is_to_reference ? " home" : " machine";
  if (action.kind != ActionKind::rapid) out += feed_text(action);
  if (action.kind == ActionKind::arc) {
    out += fmt::format(" about {} at", "XYZ"[action.normal_axis]);
    for (int i = 0; i < 3; ++i) {
      if (i != action.normal_axis) out += " " + plain_number(action.centre[i] / mm);
    }
    out += fmt::format(" turns {}", action.turns);
  }
  if (action.tool_offset != 0) out += fmt::format(" H{}", action.tool_offset);
  if (action.path_tolerance) out += " P" + plain_number(*action.path_tolerance / mm);
  if (action.is_path_mode_known && action.path_mode == PathMode::exact_stop) out += " stops";
  return out;
}

inline std::string text_of(const MachineAction& action) {
  const std::string line = fmt::format("{} ", action.line);
  switch (action.kind) {
    case ActionKind::dwell:
      return line + fmt::format("dwell {}", plain_number(action.value));
    case ActionKind::tool:
      return line + fmt::format("tool {}{}", action.number, axes_text(action));
    case ActionKind::spindle:
      return line + fmt::format("spindle {}{}",
                                action.direction < 0   ? "-"
                                : action.direction > 0 ? "+"
                                                       : "off ",
                                plain_number(action.value / rpm));
    case ActionKind::coolant:
      return line + fmt::format("coolant {}", action.number);
    case ActionKind::stop:
      return line + fmt::format("stop {}{}", action.number, axes_text(action));
    case ActionKind::end:
      return line + "end";
    default:
      return line + motion_text(action);
  }
}

inline std::string text_of(const std::vector<MachineAction>& actions) {
  std::string out;
  for (const MachineAction& action : actions) out += text_of(action) + "\n";
  return out;
}

}  // namespace servomill::controllers
