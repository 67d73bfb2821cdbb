// Configuration of FluidNC: YAML of nested keys and values.
//
// | key | meaning | source: FluidNC, Machine/Axis.cpp, Machine/Homing.h, Machine/MachineConfig.cpp
// |
// |---|---|---|
// | axes/x/max_rate_mm_per_min | of rotary axes deg/min | |
// | axes/x/acceleration_mm_per_sec2 | of rotary axes deg/s^2 | |
// | axes/x/max_travel_mm | travel, from homing/mpos_mm to the side that positive_direction names |
// Limits.cpp | | junction_deviation_mm | corners are passed as if an arc rounded them by so much |
// | | SPINDLE/spinup_ms | delay after a start | Spindles/Spindle.h |
//
// The speed changes every 10 ms (Stepper.cpp, ACCELERATION_TICKS_PER_SECOND 100).
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/input/controls/read_controls.h"
#include "sim/input/controls/settings_lines.h"

namespace servomill::sim::input {
namespace {

constexpr double kFluidNcPeriod = 10 * ms;

struct Entry {
  std::vector<std::string> path;  // "axes", "x", "max_rate_mm_per_min", in small letters
  std::string_view value;
  Place place;
};

std::string small(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

// The subset that FluidNC reads: "key: value" and sections by indentation; '#' begins a comment.
std::vector<Entry> entries_of(std::string_view text, const std::string& file,
                              SettingsFaults& faults) {
  std::vector<Entry> out;
  std::vector<std::pair<int, std::string>> sections;  // column, name
  for (const SettingsLine& line : settings_lines(text, file)) {
    std::string_view content = line.text;
    if (content.empty() || content.starts_with('#') || content.starts_with("---")) continue;
    const std::size_t colon = content.find(':');
    if (colon == std::string_view::npos) {
      faults.add(line.place, fmt::format("'{}' must be KEY: VALUE", content));
      continue;
    }
    const int column = line.place.column;
    while (!sections.empty() && sections.back().first >= column) sections.pop_back();
    const std::string name = small(without_blanks(content.substr(0, colon)));
    std::string_view value = without_blanks(content.substr(colon + 1));
    if (const std::size_t comment = value.find(" #"); comment != std::string_view::npos) {
      value = without_blanks(value.substr(0, comment));
    }
    if (value.starts_with('#')) value = {};
    if (value.empty()) {
      sections.emplace_back(column, name);
      continue;
    }
    Entry entry{{}, value, line.place};
    for (const auto& section : sections) entry.path.push_back(section.second);
    entry.path.push_back(name);
    out.push_back(std::move(entry));
  }
  return out;
}

// Home position and direction of an axis.
struct HomingOfAxis {
  double position = 0.0;  // m, rad
  bool is_positive = true;
};

class FluidNc {
 public:
  explicit FluidNc(ControlSettings& out) : out_(out) {}
  SettingsFaults& faults() { return faults_; }

  void take(const Entry& entry) {
    const std::vector<std::string>& path = entry.path;
    const bool is_axis = path.size() >= 3 && path[0] == "axes" && path[1].size() == 1;
    const auto axis = is_axis ? axis_of(path[1][0]) : std::nullopt;
    if (axis) {
      take_axis(*axis, entry);
      return;
    }
    const std::string& key = path.back();
    if (path.size() == 1 && (key == "name" || key == "board")) {
      if (key == "name") out_.name = entry.value;
      return;
    }
    if (key == "junction_deviation_mm") {
      if (const auto value = faults_.positive(entry.place, key, entry.value)) {
        out_.path_tolerance = CitedValue{*value * mm, entry.place, key};
      }
    }
    if (key == "spinup_ms") {
      if (const auto value = faults_.number(entry.place, key, entry.value)) {
        out_.spindle_time = CitedValue{*value * ms, entry.place, key};
      }
    }
  }

  // Travels follow from homing, which may be before or behind them in the file.
  void finish() {
    for (auto& [axis, limits] : out_.axes) {
      const auto travel = travels_.find(axis);
      if (travel == travels_.end()) continue;
      const HomingOfAxis home = homing_[axis];
      CitedValue lower = travel->second, upper = travel->second;
      lower.value = home.is_positive ? home.position - travel->second.value : home.position;
      upper.value = home.is_positive ? home.position : home.position + travel->second.value;
      limits.lower = lower;
      limits.upper = upper;
    }
    faults_.finish();
  }

 private:
  void take_axis(Axis axis, const Entry& entry) {
    const std::string& key = entry.path.back();
    const std::string name = fmt::format("axes/{}/{}", entry.path[1], key);
    const double unit = usual_unit(axis);
    const bool is_own = entry.path.size() == 3;
    ControlAxis& limits = out_.axes[axis];
    if (is_own && key == "max_rate_mm_per_min") {
      if (const auto value = faults_.positive(entry.place, name, entry.value)) {
        limits.v_max = CitedValue{*value * unit / minute, entry.place, name};
      }
    } else if (is_own && key == "acceleration_mm_per_sec2") {
      if (const auto value = faults_.positive(entry.place, name, entry.value)) {
        limits.a_max = CitedValue{*value * unit, entry.place, name};
      }
    } else if (is_own && key == "max_travel_mm") {
      if (const auto value = faults_.positive(entry.place, name, entry.value)) {
        travels_[axis] = CitedValue{*value * unit, entry.place, name};
      }
    } else if (key == "mpos_mm") {
      if (const auto value = faults_.number(entry.place, name, entry.value)) {
        homing_[axis].position = *value * unit;
      }
    } else if (key == "positive_direction") {
      homing_[axis].is_positive = small(entry.value) == "true";
    }
  }

  ControlSettings& out_;
  SettingsFaults faults_;
  std::map<Axis, CitedValue> travels_;  // lengths
  std::map<Axis, HomingOfAxis> homing_;
};

}  // namespace

ControlSettings read_fluidnc(std::string_view text, const std::string& file) {
  ControlSettings out;
  out.kind = ControlKind::fluidnc;
  out.file = file;
  out.name = "FluidNC machine";
  out.acceleration_time = kFluidNcPeriod;
  out.acceleration_reason = "FluidNC changes the speed every 10 ms, at constant acceleration";
  FluidNc reader(out);
  for (const Entry& entry : entries_of(text, file, reader.faults())) reader.take(entry);
  reader.finish();
  return out;
}

}  // namespace servomill::sim::input
