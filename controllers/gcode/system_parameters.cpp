// Parameters that the machine sets: numbered ones, #<_...>, and those of the parameter file.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "controllers/gcode/interpreter_machine.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kMajor = 2.9, kMinor = 0.0;  // of the LinuxCNC whose behaviour this is

double truth(bool is_true) { return is_true ? 1.0 : 0.0; }

}  // namespace

void Interpreter::Machine::load_stored_parameters() {
  parameters_.set(parameter::kDebug, 1.0);
  for (const auto& [number, value] : setup_.stored) {
    if (!parameter::is_read_only(number)) parameters_.set(number, value);
  }
}

void Interpreter::Machine::load_stored_shift() {
  if (parameters_.get(parameter::kG92Active) == 0.0) return;
  for (int i = 0; i < kAxisWords; ++i) {
    state_.shift[i] = parameters_.get(parameter::kG92 + i) * (is_linear(axis_at(i)) ? mm : deg);
  }
}

double Interpreter::Machine::system_number(int number) const {
  using namespace parameter;
  static const ToolEntry no_tool;
  const ToolEntry* found = setup_.tools.find(state_.tool);
  const ToolEntry& tool = found == nullptr ? no_tool : *found;
  if (number == kTool) return state_.tool;
  const bool is_of_tool = number > kTool && number <= kToolDiameter + 3;
  if (is_of_tool && found == nullptr && state_.tool != 0) {
    fail(0, fmt::format("#{}: length and diameter of tool {} are unknown; pass a tool table with "
                        "--tools",
                        number, state_.tool));
  }
  if (number == kToolDiameter) return tool.diameter / mm;
  if (number == kToolDiameter + 1) return tool.front_angle / deg;
  if (number == kToolDiameter + 2) return tool.back_angle / deg;
  if (number == kToolDiameter + 3) return tool.orientation;
  const int offset = number - kTool - 1;
  if (offset >= 0 && offset < kAxisWords) {
    return tool.offset[offset] / (is_linear(axis_at(offset)) ? mm : deg);
  }
  const int axis = number - kPosition;
  if (axis >= 0 && state_.compensation.is_on && !is_printing_) {
    fail(0,
         fmt::format("#{} is unknown with cutter compensation active; program G40 first", number));
  }
  if (axis >= 0 && axis < kAxisWords) {
    require_height(axis_at(axis), fmt::format("{}", number));
    return state_.position[axis] / unit_of(axis_at(axis));
  }
  return 0.0;
}

// Z with a tool of unknown length.
void Interpreter::Machine::require_height(Axis axis, std::string_view name) const {
  if (axis != Axis::Z || (!state_.is_height_unknown && !state_.is_length_unknown)) return;
  fail(0, fmt::format("#{}: Z depends on the unknown tool length; pass a tool table with --tools",
                      name));
}

double Interpreter::Machine::feed_in_force() const {
  const double per = state_.feed_mode == FeedMode::units_per_revolution ? 1.0 : minute;
  return state_.feed_linear * per / state_.unit;
}

double Interpreter::Machine::pocket_of(int number) const {
  const ToolEntry* tool = setup_.tools.find(number);
  return tool == nullptr ? 0.0 : tool->pocket;
}

std::optional<double> Interpreter::Machine::system_name(std::string_view name) const {
  if (name.size() < 2 || name[0] != '_') return std::nullopt;
  if (name.size() == 2) {
    if (const auto axis = axis_of(name[1])) {
      require_height(*axis, name);
      return state_.position[index_of(*axis)] / unit_of(*axis);
    }
    if (name[1] >= 'u' && name[1] <= 'w') return 0.0;  // axes that there are not
  }
  if (name.size() == 6 && name.starts_with("_abs_")) {
    if (const auto axis = axis_of(name[5])) {
      require_height(*axis, name);
      return machine_now(0)[index_of(*axis)] / unit_of(*axis);
    }
  }
  using Read = double (*)(const Machine&);
  // sorted by name. Source: LinuxCNC 2.9, "Predefined Named Parameters"
  static constexpr auto kNames = std::to_array<std::pair<std::string_view, Read>>({
      {"_absolute", [](const Machine& m) { return truth(!m.state_.is_incremental); }},
      {"_adaptive_feed", [](const Machine& m) { return truth(m.state_.adaptive_feed); }},
      {"_call_level", [](const Machine& m) { return static_cast<double>(m.flow_.calls.size()); }},
      {"_ccomp",
       [](const Machine& m) { return !m.state_.compensation.is_on ? 400.0 : m.state_.compensation.cutter.is_left ? 410.0 : 420.0; }},
      {"_coord_system",
       [](const Machine& m) {
         const int n = m.state_.work_system;
         return n < 7 ? 530.0 + 10.0 * n : 584.0 + n;
       }},
      {"_current_pocket", [](const Machine& m) { return m.pocket_of(m.state_.tool); }},
      {"_current_tool", [](const Machine& m) { return static_cast<double>(m.state_.tool); }},
      {"_feed", [](const Machine& m) { return m.feed_in_force(); }},
      {"_feed_hold", [](const Machine& m) { return truth(m.state_.feed_hold); }},
      {"_feed_override", [](const Machine& m) { return truth(m.state_.feed_override); }},
      {"_flood", [](const Machine& m) { return truth((m.state_.coolant & kFlood) != 0); }},
      {"_ijk_absolute_mode", [](const Machine& m) { return truth(m.state_.is_centre_absolute); }},
      {"_imperial", [](const Machine& m) { return truth(m.state_.unit != mm); }},
      {"_incremental", [](const Machine& m) { return truth(m.state_.is_incremental); }},
      {"_inverse_time",
       [](const Machine& m) { return truth(m.state_.feed_mode == FeedMode::inverse_time); }},
      {"_lathe_diameter_mode", [](const Machine&) { return 0.0; }},
      {"_lathe_radius_mode", [](const Machine&) { return 1.0; }},
      {"_line", [](const Machine& m) { return static_cast<double>(m.line()); }},
      {"_metric", [](const Machine& m) { return truth(m.state_.unit == mm); }},
      {"_mist", [](const Machine& m) { return truth((m.state_.coolant & kMist) != 0); }},
      {"_motion_mode", [](const Machine& m) { return static_cast<double>(m.state_.motion); }},
      {"_plane",
       [](const Machine& m) {
         const double plane = 190.0 - 10.0 * m.state_.normal_axis;
         return plane + truth(m.state_.is_uvw_plane);
       }},
      {"_remap_level", [](const Machine&) { return 0.0; }},
      {"_retract_old_z", [](const Machine& m) { return truth(!m.state_.retracts_to_r); }},
      {"_retract_r_plane", [](const Machine& m) { return truth(m.state_.retracts_to_r); }},
      {"_rpm", [](const Machine& m) { return m.state_.spindle_speed / rpm; }},
      {"_selected_pocket",
       [](const Machine& m) {
         return m.state_.selected_tool < 0 ? -1.0 : m.pocket_of(m.state_.selected_tool);
       }},
      {"_selected_tool",
       [](const Machine& m) { return static_cast<double>(std::max(m.state_.selected_tool, 0)); }},
      {"_speed_override", [](const Machine& m) { return truth(m.state_.speed_override); }},
      {"_spindle_css_mode", [](const Machine&) { return 0.0; }},
      {"_spindle_cw", [](const Machine& m) { return truth(m.state_.spindle_direction > 0); }},
      {"_spindle_on", [](const Machine& m) { return truth(m.state_.spindle_direction != 0); }},
      {"_spindle_rpm_mode", [](const Machine&) { return 1.0; }},
      {"_task", [](const Machine&) { return 0.0; }},
      {"_tool_offset",
       [](const Machine& m) { return truth(m.state_.tool_offset != AxisWords::Zero()); }},
      {"_units_per_minute",
       [](const Machine& m) { return truth(m.state_.feed_mode == FeedMode::units_per_minute); }},
      {"_units_per_rev",
       [](const Machine& m) {
         return truth(m.state_.feed_mode == FeedMode::units_per_revolution);
       }},
      {"_value", [](const Machine& m) { return m.flow_.value; }},
      {"_value_returned", [](const Machine& m) { return truth(m.flow_.has_value); }},
      {"_vmajor", [](const Machine&) { return kMajor; }},
      {"_vminor", [](const Machine&) { return kMinor; }},
  });
  const auto by_name = [](const auto& entry, std::string_view key) { return entry.first < key; };
  const auto found = std::lower_bound(kNames.begin(), kNames.end(), name, by_name);
  if (found == kNames.end() || found->first != name) return std::nullopt;
  return found->second(*this);
}

}  // namespace servomill::controllers
