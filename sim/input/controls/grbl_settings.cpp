// Settings of grbl 1.1 and grblHAL, as `$$` lists them: "$110=1500.000 (X-axis maximum rate)".
//
// | setting | meaning | source: grbl v1.1, doc/markdown/settings.md |
// |---|---|---|
// | $11 | junction deviation, mm | corners are passed as if an arc rounded them by so much |
// | $110 ... $115 | maximum rate of X Y Z A B C, mm/min or deg/min | |
// | $120 ... $125 | acceleration, mm/s^2 or deg/s^2 | |
// | $130 ... $135 | maximum travel, mm or deg | |
// | $392 | spindle delay, s | grblHAL: "Spindle on delay" |
//
// Machine coordinates are [-travel, 0] (grbl/system.c, system_check_travel_limits, without
// HOMING_FORCE_SET_ORIGIN). Settings are in mm also with $13=1, which is for reports of positions.
// The speed changes every 10 ms (config.h, ACCELERATION_TICKS_PER_SECOND 100).
#include <fmt/format.h>

#include <charconv>

#include "plant/vocabulary/units.h"
#include "sim/input/controls/read_controls.h"
#include "sim/input/controls/settings_lines.h"

namespace servomill::sim::input {
namespace {

constexpr double kGrblPeriod = 10 * ms;

struct Setting {
  int number = 0;
  std::string_view value;
  Place place;
};

// "$110=1500.000 (comment)", with what a terminal prints around it; none: it is no setting.
std::optional<Setting> setting_of(const SettingsLine& line) {
  const std::size_t dollar = line.text.find('$');
  const std::size_t equals = line.text.find('=', dollar);
  if (dollar == std::string_view::npos || equals == std::string_view::npos) return std::nullopt;
  const std::string_view name = without_blanks(line.text.substr(dollar + 1, equals - dollar - 1));
  Setting out;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), out.number);
  if (error != std::errc() || end != name.data() + name.size()) return std::nullopt;
  std::string_view value = line.text.substr(equals + 1);
  value = value.substr(0, value.find_first_of("(;|,"));
  out.value = without_blanks(value);
  out.place = line.place;
  out.place.column += static_cast<int>(dollar);
  return out;
}

// Takes the settings one after the other; the last of a number counts, as on the control.
class Grbl {
 public:
  explicit Grbl(ControlSettings& out) : out_(out) {}

  void take(const Setting& setting) {
    constexpr int kAxes = 6, kRate = 110, kAcceleration = 120, kTravel = 130;
    const std::string key = fmt::format("${}", setting.number);
    const int group = setting.number / 10 * 10, index = setting.number % 10;
    const bool is_of_axis = group >= kRate && group <= kTravel && index < kAxes;
    if (is_of_axis) {
      const auto value = faults_.positive(setting.place, key, setting.value);
      if (!value) return;
      const Axis axis = kAllAxes[static_cast<std::size_t>(index)];
      ControlAxis& limits = out_.axes[axis];
      const double unit = usual_unit(axis);
      if (group == kRate) limits.v_max = CitedValue{*value * unit / minute, setting.place, key};
      if (group == kAcceleration) limits.a_max = CitedValue{*value * unit, setting.place, key};
      if (group != kTravel) return;
      limits.lower = CitedValue{-*value * unit, setting.place, key};
      limits.upper = CitedValue{0.0, setting.place, key};
      return;
    }
    if (setting.number == 11) {
      if (const auto value = faults_.positive(setting.place, key, setting.value)) {
        out_.path_tolerance = CitedValue{*value * mm, setting.place, key + ", junction deviation"};
      }
    }
    if (setting.number == 392) {
      if (const auto value = faults_.number(setting.place, key, setting.value)) {
        out_.spindle_time = CitedValue{*value, setting.place, key};
      }
    }
  }
  void finish() { faults_.finish(); }

 private:
  ControlSettings& out_;
  SettingsFaults faults_;
};

}  // namespace

ControlSettings read_grbl(std::string_view text, const std::string& file) {
  ControlSettings out;
  out.kind = ControlKind::grbl;
  out.file = file;
  out.name = "grbl machine";
  out.acceleration_time = kGrblPeriod;
  out.acceleration_reason = "grbl changes the speed every 10 ms, at constant acceleration";
  Grbl grbl(out);
  for (const SettingsLine& line : settings_lines(text, file)) {
    if (const auto setting = setting_of(line)) grbl.take(*setting);
  }
  grbl.finish();
  return out;
}

}  // namespace servomill::sim::input
