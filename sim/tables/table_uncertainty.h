/// Uncertainty of the values that tables hold, and which of them are not written for it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/model/determination.h"
#include "sim/tables/table_export.h"

namespace servomill::sim::tables {

/// Corrections at several places, judged together.
/// @param values, expanded  in one unit
model::Determination determination(const Eigen::VectorXd& values, const Eigen::VectorXd& expanded);

/// Gives each table its uncertainty. Formats of displacements lose those that are not determined:
/// they become omitted tables.
/// Nothing is done without identified errors.
void take_uncertainty(TableExport& tables);

/// Formats that hold the errors themselves: these count in combination only, so that the tip is
/// judged, at poses all over the travel and relative to the reference.
/// @throws InputError where a coordinate of the tip is not determined, and matters
void refuse_undetermined_tip(const TableExport& tables);

/// "; U(k = 2) up to 3.2 um", or nothing where it is not known.
std::string uncertainty_text(const CompensationTable& table);

/// Lines of a report on tables that are not written since they are not determined.
std::vector<std::string> undetermined_lines(const TableExport& tables);

}  // namespace servomill::sim::tables
