/// Readings of heat from the day of a result file.
#pragma once

#include <string>

namespace servomill::sim::calibration {
struct HeatReadings;  // sim/calibration/heat_regression.h
}  // namespace servomill::sim::calibration

namespace servomill::tools {

class Options;

/// Temperatures and drift of the day of a case, of --case or the only one.
/// @throws InputError if the file has no such day, or a strategy has reduced the drift
sim::calibration::HeatReadings day_readings(const std::string& path, const Options& options);

}  // namespace servomill::tools
