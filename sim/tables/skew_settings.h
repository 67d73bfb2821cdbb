/// Squareness of X, Y and Z as a skew correction of a firmware.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/tables/skew.h"
#include "sim/tables/table_export.h"
#include "sim/tables/table_files.h"
#include "sim/tables/verify_tables.h"

namespace servomill::sim::tables {

/// Factors that a calibration does not determine (table_uncertainty.h) are left out.
/// @param is_required  axes at right angles are a fault; otherwise nothing is returned
/// @throws InputError if the machine has no X, Y and Z
std::optional<SkewSettings> skew_settings_of(const TableExport& tables, bool is_required);

std::vector<std::string> skew_report(const TableExport& tables);

/// skew.gcode (Marlin), skew.cfg (Klipper), skew.g (RepRapFirmware).
std::vector<TextFile> skew_files(const TableExport& tables);

/// Reads the file as the firmware does and evaluates its formulas on the kinematics of the machine
/// with its location errors: the directions of motion must be at right angles to a digit.
/// @throws InputError with file and line
TableVerification verify_skew(const TableExport& tables, const std::vector<TextFile>& files);

}  // namespace servomill::sim::tables
