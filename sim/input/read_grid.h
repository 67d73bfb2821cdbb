/// Reads errors over several axes.
#pragma once

#include "plant/geometry/error_function.h"
#include "plant/vocabulary/axes.h"
#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// Axes of the machine that has the errors, and their travel.
struct MachineAxes {
  JointLayout layout;
  Joints lower, upper;  // m, rad; infinite: endless, or not known
  bool is_travel_known = false;

  MachineAxes(const JointLayout& layout);  ///< of unknown travel
  explicit MachineAxes(const model::MachineSettings& machine);

  /// A rotary axis without limits.
  bool is_endless(Axis axis) const;
};

/// A grid: `{ axes = "XZ", at_mm = [[...], [...]], value_um = [[...], ...] }`. Faults: axes that
/// the machine lacks, positions that do not cover their travel, values that are not one for each
/// combination; the function is then empty.
/// @param is_length  the error is a length, else an angle
plant::ErrorFunction read_grid(config::Reader& table, bool is_length, const MachineAxes& machine);

}  // namespace servomill::sim::input
