/// Check of a recorded motion against the path of its program: how far it leaves it, and how near
/// it comes to the corners.
#pragma once

#include "sim/limits/logged_path.h"
#include "sim/limits/path_report.h"
#include "sim/limits/programmed_path.h"

namespace servomill::sim::limits {

/// Directions that differ by less are no corner.
inline constexpr double kMinCorner = 0.0175;  // rad, 1 deg

PathReport check_path(const ProgrammedPath& program, const LoggedPath& log);

}  // namespace servomill::sim::limits
