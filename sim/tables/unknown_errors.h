/// Errors that a calibration has not determined: tables would hold 0 for them.
#pragma once

#include <string>
#include <vector>

#include "sim/tables/table_export.h"

namespace servomill::sim::tables {

/// @throws InputError where nothing that a table, a skew correction or a bed mesh holds is known
void refuse_unknown(const TableExport& tables);

/// Appends "note: not determined by the calibration, taken as 0: ECY, ECZ" to the lines of a
/// report; nothing where all is known.
std::vector<std::string> with_unknown(std::vector<std::string> lines, const TableExport& tables);

}  // namespace servomill::sim::tables
