/// The quantities that are values along the path of a case: largest value, range, mean or rms of
/// deviations and of differences from another case.
///
/// Recordings are read row by row and nothing is kept of a row, so they may be long. Of a thinned
/// recording (sim/records/row_thinning.h), quantities of one case are those of all samples; a
/// difference of two cases is looked at where a row stays, and the deviation of the other case from
/// the programmed path is linear from row to row.
#pragma once

#include <span>

#include "sim/evaluation/quantity.h"

namespace servomill::sim::evaluation {

/// Entries of this family, and of the program that the NC runs.
std::span<const QuantityEntry> path_quantities();

}  // namespace servomill::sim::evaluation
