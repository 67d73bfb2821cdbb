// INI file of LinuxCNC 2.7 to 2.9 (documentation: "INI Configuration", config/ini-config).
//
// | key | meaning |
// |---|---|
// | [TRAJ] COORDINATES | letters of the axes: "X Y Z", XYYZ for a gantry |
// | [KINS] KINEMATICS | trivkins coordinates=XYYZ names the axis of each joint |
// | [TRAJ] LINEAR_UNITS | mm, metric, in, inch, imperial, or units per mm |
// | [TRAJ] ANGULAR_UNITS | deg, degree, rad, radian, grad, gon |
// | [AXIS_X], [JOINT_0] MAX_VELOCITY, MAX_ACCELERATION | units per s, s^2 |
// | [AXIS_X], [JOINT_0] MIN_LIMIT, MAX_LIMIT | units |
// | [EMCMOT] SERVO_PERIOD | ns |
// | [RS274NGC] RS274NGC_STARTUP_CODE | G64 P: path tolerance, in the unit of its G20 or G21 |
//
// The stricter limit of axis and joint counts: the trajectory keeps those of the axes, and the
// motion those of the joints. Files of 2.7 and before have [AXIS_0] in place of both, with the
// letters XYZABC in this order. Of keys that come twice the first counts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <span>

#include "plant/vocabulary/units.h"
#include "sim/config/option_value.h"
#include "sim/input/controls/read_controls.h"
#include "sim/input/controls/settings_lines.h"
#include "sim/system/read_file.h"

namespace servomill::sim::input {
namespace {

struct IniValue {
  std::string value;
  Place place;
};
using Ini = std::map<std::string, IniValue, std::less<>>;  // "[TRAJ] COORDINATES"

constexpr double kNoLimit = 1e5;  // mm, deg: beyond it a limit is the word for none

class IniReader {
 public:
  explicit IniReader(SettingsFaults& faults) : faults_(faults) {}

  void read(std::string_view text, const std::string& file, int depth = 0) {
    for (const SettingsLine& line : settings_lines(text, file)) {
      if (line.text.starts_with("#INCLUDE")) {
        include(line, file, depth);
      } else if (line.text.starts_with('[')) {
        section_ = std::string(line.text.substr(0, line.text.find(']') + 1));
      } else if (!line.text.empty() && line.text[0] != '#' && line.text[0] != ';') {
        add(line);
      }
    }
  }
  const Ini& ini() const { return ini_; }

 private:
  void add(const SettingsLine& line) {
    const std::size_t equals = line.text.find('=');
    if (equals == std::string_view::npos) return;
    const std::string_view key = without_blanks(line.text.substr(0, equals));
    std::string_view value = line.text.substr(equals + 1);
    for (const char* comment : {" #", "\t#", " ;", "\t;"})
      value = value.substr(0, value.find(comment));
    ini_.try_emplace(fmt::format("{} {}", section_, key),
                     IniValue{std::string(without_blanks(value)), line.place});
  }

  // Files that are included, relative to the one that includes them.
  void include(const SettingsLine& line, const std::string& file, int depth) {
    constexpr int kDeepest = 10;
    const std::string name(without_blanks(line.text.substr(std::string_view("#INCLUDE").size())));
    if (depth >= kDeepest) {
      faults_.add(line.place, "#INCLUDE is nested too deep");
      return;
    }
    const std::filesystem::path path = std::filesystem::path(file).parent_path() / name;
    read(system::read_file(path.string(), line.place, "included file"), path.string(), depth + 1);
  }

  SettingsFaults& faults_;
  std::string section_;
  Ini ini_;
};

class LinuxCnc {
 public:
  LinuxCnc(const Ini& ini, SettingsFaults& faults, ControlSettings& out)
      : ini_(ini), faults_(faults), out_(out) {}

  void read() {
    if (const IniValue* name = find("[EMC] MACHINE"); name != nullptr && !name->value.empty()) {
      out_.name = name->value;
    }
    read_units();
    read_period();
    read_kinematics();
    read_axes();
    read_tolerance();
    note("[TRAJ] MAX_LINEAR_VELOCITY", "limits the path velocity in addition to the axes");
    note("[TRAJ] MAX_LINEAR_ACCELERATION", "limits the path acceleration in addition to the axes");
  }

 private:
  const IniValue* find(const std::string& key) const {
    const auto found = ini_.find(key);
    return found == ini_.end() ? nullptr : &found->second;
  }

  void note(const std::string& key, const char* what) {
    const IniValue* value = find(key);
    if (value == nullptr) return;
    out_.notes.push_back(
        fmt::format("{} = {} ({}) {}", key, value->value, to_string(value->place), what));
  }

  void read_units() {
    struct Unit {
      std::string_view name;
      double value;  // SI
    };
    constexpr std::array kLinear = {Unit{"mm", mm}, Unit{"metric", mm}, Unit{"in", inch},
                                    Unit{"inch", inch}, Unit{"imperial", inch}};
    constexpr std::array kAngular = {
        Unit{"deg", deg},    Unit{"degree", deg},     Unit{"degrees", deg},  Unit{"rad", 1.0},
        Unit{"radian", 1.0}, Unit{"grad", 0.9 * deg}, Unit{"gon", 0.9 * deg}};
    const auto read = [&](const std::string& key, std::span<const Unit> units, double per_number,
                          double& into) {
      const IniValue* value = find(key);
      if (value == nullptr) return false;
      const auto known = std::find_if(units.begin(), units.end(),
                                      [&](const Unit& unit) { return unit.name == value->value; });
      if (known != units.end()) {
        into = known->value;
      } else if (const auto number = config::plain_number(value->value); number && *number > 0.0) {
        into = per_number / *number;
      } else {
        faults_.add(value->place, fmt::format("{} = {}; is no unit", key, value->value));
      }
      return true;
    };
    if (!read("[TRAJ] LINEAR_UNITS", kLinear, mm, linear_)) {
      faults_.add({out_.file}, "[TRAJ] LINEAR_UNITS is missing: mm or inch");
    }
    if (!read("[TRAJ] ANGULAR_UNITS", kAngular, deg, angular_)) angular_ = deg;
  }

  void read_period() {
    const std::string key = "[EMCMOT] SERVO_PERIOD";
    const IniValue* value = find(key);
    if (value == nullptr) {
      constexpr double kDefault = 1e-3;  // s, of motmod
      out_.acceleration_time = kDefault;
      out_.acceleration_reason =
          "LinuxCNC plans with constant acceleration, which changes within a servo period; "
          "[EMCMOT] SERVO_PERIOD is missing: 1 ms is the default of motmod";
      return;
    }
    if (const auto period = faults_.positive(value->place, key, value->value)) {
      out_.period = CitedValue{*period * 1e-9, value->place, key};
      out_.acceleration_time = *period * 1e-9;
      out_.acceleration_reason = fmt::format(
          "LinuxCNC plans with constant acceleration, which changes within a servo period of "
          "{:g} ms",
          *period * 1e-6);
    }
  }

  // Letters of the joints in their order.
  static std::string letters_of(std::string_view text) {
    std::string out;
    for (const char c : text) {
      const char upper = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
      if (upper >= 'A' && upper <= 'Z') out += upper;
    }
    return out;
  }

  void read_kinematics() {
    const IniValue* coordinates = find("[TRAJ] COORDINATES");
    letters_ = coordinates != nullptr ? letters_of(coordinates->value) : "XYZ";
    if (coordinates == nullptr) {
      faults_.add({out_.file}, "[TRAJ] COORDINATES is missing: the letters of the axes");
    }
    const IniValue* kinematics = find("[KINS] KINEMATICS");
    if (kinematics == nullptr) return;
    const std::string_view text = kinematics->value;
    const std::string_view module = text.substr(0, text.find_first_of(" \t"));
    if (const std::size_t at = text.find("coordinates="); at != std::string_view::npos) {
      const std::string_view rest = text.substr(at + std::string_view("coordinates=").size());
      letters_ = letters_of(rest.substr(0, rest.find_first_of(" \t")));
    }
    struct Known {
      std::string_view module, structure;
    };
    // Documentation: "5-Axis Kinematics", motion/5-axis-kinematics: tilting tables
    constexpr std::array kKnown = {Known{"xyzac-trt-kins", "[w C' A' b X Y Z (C1) t]"},
                                   Known{"xyzbc-trt-kins", "[w C' B' b X Y Z (C1) t]"}};
    for (const Known& known : kKnown) {
      if (known.module != module) continue;
      out_.structure = known.structure;
      out_.structure_reason = fmt::format(
          "[KINS] KINEMATICS ({}); the centres of the rotary axes "
          "are pins of HAL and missing here",
          to_string(kinematics->place));
      letters_ = module == "xyzac-trt-kins" ? "XYZAC" : "XYZBC";
      return;
    }
    if (module == "trivkins") return;
    out_.notes.push_back(fmt::format(
        "[KINS] KINEMATICS = {} ({}): joints are not axes, limits of joints are omitted",
        kinematics->value, to_string(kinematics->place)));
    joints_are_axes_ = false;
  }

  // The stricter of what is known and another value.
  template <class IsStricter>
  void take(std::optional<CitedValue>& into, const std::string& key, double unit, bool is_positive,
            IsStricter is_stricter) {
    const IniValue* value = find(key);
    if (value == nullptr) return;
    const auto number = is_positive ? faults_.positive(value->place, key, value->value)
                                    : faults_.number(value->place, key, value->value);
    if (!number || std::abs(*number) * unit > kNoLimit * (unit < 0.1 ? mm : deg)) return;
    const double si = *number * unit;
    if (!into || is_stricter(si, into->value)) into = CitedValue{si, value->place, key};
  }

  void take_section(const std::string& section, Axis axis, ControlAxis& limits) {
    const double unit = is_linear(axis) ? linear_ : angular_;
    const auto less = [](double a, double b) { return a < b; };
    const auto more = [](double a, double b) { return a > b; };
    take(limits.v_max, section + " MAX_VELOCITY", unit, true, less);
    take(limits.a_max, section + " MAX_ACCELERATION", unit, true, less);
    const IniValue* wrapped = find(section + " WRAPPED_ROTARY");
    if (wrapped != nullptr && wrapped->value != "0") endless_.insert(axis);
    take(limits.lower, section + " MIN_LIMIT", unit, false, more);
    take(limits.upper, section + " MAX_LIMIT", unit, false, less);
  }

  void read_axes() {
    const bool is_old =
        find("[JOINT_0] MAX_VELOCITY") == nullptr && find("[AXIS_0] MAX_VELOCITY") != nullptr;
    for (std::size_t joint = 0; joint < letters_.size(); ++joint) {
      const auto axis = axis_of(letters_[joint]);
      if (!axis) {
        out_.notes.push_back(
            fmt::format("axis {} is omitted: a machine has X Y Z A B C", letters_[joint]));
        continue;
      }
      ControlAxis& limits = out_.axes[*axis];
      if (is_old) {
        take_section(fmt::format("[AXIS_{}]", index_of(*axis)), *axis, limits);
        continue;
      }
      take_section(fmt::format("[AXIS_{}]", letters_[joint]), *axis, limits);
      if (joints_are_axes_) take_section(fmt::format("[JOINT_{}]", joint), *axis, limits);
    }
    for (const Axis axis : endless_) out_.axes[axis].lower = out_.axes[axis].upper = std::nullopt;
  }

  void read_tolerance() {
    const std::string key = "[RS274NGC] RS274NGC_STARTUP_CODE";
    const IniValue* value = find(key);
    if (value == nullptr) return;
    std::string code = value->value;
    std::erase_if(code, [](char c) { return c == ' ' || c == '\t'; });
    for (char& c : code) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    const std::size_t at = code.find("G64P");
    if (at == std::string::npos) return;
    const std::size_t from = at + 4;
    const std::size_t end = code.find_first_not_of("0123456789.", from);
    const auto tolerance = config::plain_number(std::string_view(code).substr(from, end - from));
    if (!tolerance || !(*tolerance > 0.0)) return;
    const double unit = code.find("G21") != std::string::npos   ? mm
                        : code.find("G20") != std::string::npos ? inch
                                                                : linear_;
    out_.path_tolerance = CitedValue{*tolerance * unit, value->place, key + ", G64 P"};
  }

  const Ini& ini_;
  SettingsFaults& faults_;
  ControlSettings& out_;
  double linear_ = mm, angular_ = deg;
  std::string letters_;
  bool joints_are_axes_ = true;
  std::set<Axis> endless_;
};

}  // namespace

ControlSettings read_linuxcnc(std::string_view text, const std::string& file) {
  ControlSettings out;
  out.kind = ControlKind::linuxcnc;
  out.file = file;
  out.name = "LinuxCNC machine";
  SettingsFaults faults;
  IniReader ini(faults);
  ini.read(text, file);
  LinuxCnc(ini.ini(), faults, out).read();
  faults.finish();
  return out;
}

}  // namespace servomill::sim::input
