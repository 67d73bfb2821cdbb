/// Errors that a calibration has not determined: tables would hold 0 for them.
#pragma once

#include <string>
#include <vector>

#include "plant/geometry/error_model.h"
#include "sim/model/tip_uncertainty.h"
#include "sim/tables/table_export.h"

namespace servomill::sim::tables {

/// Component errors and squarenesses of the machine that have neither an identified number nor a
/// value in the model. A squareness may be given for either of its two axes: EC0X or EC0Y.
std::vector<plant::ErrorName> unknown_errors(const plant::ErrorModel& errors,
                                             const model::UncertainErrors& identified,
                                             const JointLayout& layout);

/// @throws InputError where nothing that a table, a skew correction or a bed mesh holds is known
void refuse_unknown(const TableExport& tables);

/// Appends "note: not determined by the calibration, taken as 0: ECY, ECZ" to the lines of a
/// report; nothing where all is known.
std::vector<std::string> with_unknown(std::vector<std::string> lines, const TableExport& tables);

}  // namespace servomill::sim::tables
