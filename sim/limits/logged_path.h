/// A recorded motion as places of the machine.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/limits/log_signals.h"
#include "sim/programs/compensate/program_corrector.h"

namespace servomill::sim::limits {

struct LoggedPath {
  std::vector<double> t;              // s
  std::vector<AxisWords> at;          // machine coordinates (6; m, rad); 0 where none is recorded
  programs::AxisFlags is_recorded{};  // of each axis
  AxisWords quantum = AxisWords::Zero();  // resolution (6; m, rad)

  bool has_rotary() const { return is_recorded[3] || is_recorded[4] || is_recorded[5]; }
};

/// @param file        of the recording, for messages
/// @param resolution  of positions, m or rad; 0: that of the samples
/// @throws InputError where a linear axis of the machine is not recorded as a position, or axes
/// have other times than each other
LoggedPath logged_path(const std::string& file, std::span<const AxisSignal> signals,
                       const JointLayout& layout, double resolution);

}  // namespace servomill::sim::limits
