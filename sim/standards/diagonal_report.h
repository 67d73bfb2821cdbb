/// Diagonal displacement tests after ISO 230-6: the parameters of ISO 230-2 along the diagonals of
/// the working volume or of a face.
#pragma once

#include <vector>

#include "sim/standards/positioning_readings.h"
#include "sim/standards/report.h"

namespace servomill::sim::standards {

/// E_d, R_d, B_d, A_d: the largest of all diagonals; and the parameters of each.
Report diagonal_report(const std::vector<PositioningFile>& diagonals);

}  // namespace servomill::sim::standards
