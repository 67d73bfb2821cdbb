/// A calibration in words and tables.
#pragma once

#include <string>
#include <vector>

#include "sim/calibration/calibration.h"

namespace servomill::sim::calibration {

/// Everything that `servomill calibrate` prints.
std::string report(const Calibration& calibration);

/// Sentences on readings that contradict each other or stand out, with file and line.
std::vector<std::string> warnings(const Calibration& calibration);

}  // namespace servomill::sim::calibration
