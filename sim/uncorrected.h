/// What a strategy that corrects tip and tool axis cannot correct, looked for before anything runs.
#pragma once

#include <optional>

#include "sim/program_path.h"
#include "strategies/compensation.h"

namespace servomill::sim {

struct Uncorrected {
  int line = 0;
  double tip = 0.0;             // m, largest believed deviation that is left on that line
  double axis = 0.0;            // rad
  double singular_angle = 0.0;  // rad, of the tool axis from a singular direction there
};

/// Of this and less nothing is said.
inline constexpr double kUncorrectedTip = 0.1e-6;  // m
inline constexpr double kUncorrectedAxis = 1e-6;   // rad

/// The place of the feed motion where most is left of the tool axis or, where of none much is left,
/// of the tip: at the ends of lines, and each degree that a rotary axis turns on them.
/// @param sigma_0  sine of `singular_deg` (strategies/pose_compensation.h)
/// @return nothing if all is corrected
std::optional<Uncorrected> uncorrected(const ProgramPath& path, const strategies::Belief& belief,
                                       strategies::Iterations iterations, double sigma_0);

}  // namespace servomill::sim
