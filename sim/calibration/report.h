/// A calibration in words and tables.
#pragma once

#include <string>
#include <vector>

#include "sim/calibration/calibration.h"

namespace servomill::sim::calibration {

/// Everything that `servomill calibrate` prints.
std::string report(const Calibration& calibration);

/// The same as one JSON object: groups, errors with U (k = 2), sentences on errors that the
/// readings do not determine, and the given suggestions.
std::string report_json(const Calibration& calibration,
                        const std::vector<std::string>& suggestions);

/// CSV of every error along the travel: name, position (mm or deg; empty for location errors),
/// value, standard uncertainty (um or urad), and whether it holds others or a part of it is left
/// out.
std::string function_table(const Calibration& calibration);

/// "0.52 um", "1.3 urad": a value (m, rad) of the readings of a group.
std::string in_unit(double value, const readings::Group& group);

/// Refuses a calibration whose readings contradict each other: tables and programs would follow it.
/// @throws InputError that names the groups
void refuse_contradictions(const Calibration& calibration);

/// Sentences on readings that contradict each other or stand out, with file and line.
std::vector<std::string> warnings(const Calibration& calibration);

}  // namespace servomill::sim::calibration
