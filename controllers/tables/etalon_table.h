/// Parameter files of Etalon's exchange format, variant "Vendor", as TF5280 reads them.
#pragma once

#include "controllers/tables/csv_table.h"

namespace servomill::controllers {

/// Component and position errors of one file.
///
/// Rules (Beckhoff, TF5280 TwinCAT 3 CNC Volumetric Compensation; on infosys.beckhoff.com under
/// content/1033/tf5280_volumetric_comp/: Etalon Exchange Format, 296430091.html; Units of measure,
/// 296426379.html). The format belongs to Etalon; no document of its own was found:
///   - a block begins with the name of a parameter in brackets; // begins a comment
///   - position error: VALUE = number, in mm or rad
///   - component error: Gridpoints = { pairs of argument and value }, one pair a line; arguments in
///     mm or deg, values in mm or rad
///
/// Anything else is refused by name.
/// @throws InputError with file and line
ErrorColumns read_etalon_table(const TableText& file);

}  // namespace servomill::controllers
