/// A machine file written from the settings of a real control.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/input/controls/control_settings.h"

namespace servomill::sim::input {

/// Values that the user gives in place of assumptions.
struct DraftChoices {
  std::string structure = {};                    // "[w C' A' b X Y Z (C1) t]"
  std::optional<double> acceleration_time = {};  // s, in which the acceleration rises
  std::optional<double> path_tolerance = {};     // m
};

struct MachineDraft {
  std::string text;                      // TOML; it reads as a machine
  std::vector<std::string> axes;         // "X: 0 ... 300 mm, 1500 mm/min, 300 mm/s^2"
  std::vector<std::string> assumptions;  // values that the settings do not give
  std::vector<std::string> notes;        // settings that a machine file has no key for
};

/// The file is read back before it is returned.
/// @throws InputError if limits of an axis are missing
MachineDraft machine_draft(const ControlSettings& settings, const DraftChoices& choices);

}  // namespace servomill::sim::input
