/// Settings of real controls: limits of axes, periods and tolerances as their own files give them.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::input {

/// The unit in which all of these controls count, but for LinuxCNC: mm, deg.
inline double usual_unit(Axis axis) { return is_linear(axis) ? mm : deg; }

/// Controls whose settings are read.
enum class ControlKind : std::uint8_t { linuxcnc, grbl, fluidnc, rrf };
inline constexpr std::array<std::string_view, 4> kControlKinds = {"linuxcnc", "grbl", "fluidnc",
                                                                  "rrf"};

/// A value in SI, and where it comes from.
struct CitedValue {
  double value = 0.0;
  Place place;
  std::string key;  // as the file names it: "[AXIS_X] MAX_VELOCITY"
};

struct ControlAxis {
  std::optional<CitedValue> v_max, a_max, j_max;  // m/s, rad/s ...
  std::optional<CitedValue> lower, upper;         // m, rad; without both: endless, or not known
};

/// Machine as a file of settings describes it. Empty: it does not say.
struct ControlSettings {
  ControlKind kind = ControlKind::linuxcnc;
  std::string file;
  std::string name;
  std::map<Axis, ControlAxis> axes;
  std::optional<CitedValue> period;          // s, of its setpoints
  std::optional<CitedValue> path_tolerance;  // m
  std::optional<CitedValue> spindle_time;    // s, of a start
  std::string structure;           // of a kinematics that the file names; empty: that of no machine
  std::string structure_reason;    // then
  double acceleration_time = 0.0;  // s, in which the acceleration of the control rises
  std::string acceleration_reason;  // why
  std::vector<std::string> notes;   // what else it says that a machine file has no key for
};

/// The control whose file this is, by its contents; none: unknown.
std::optional<ControlKind> kind_of_settings(std::string_view text);

/// @param text  of the file, of a LinuxCNC INI with what it includes
/// @throws InputError with every fault
ControlSettings read_control_settings(ControlKind kind, std::string_view text,
                                      const std::string& file);

}  // namespace servomill::sim::input
