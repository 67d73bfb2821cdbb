/// The quantities that are values along the path of a case: largest value, range, mean or rms of
/// deviations and of differences from another case.
///
/// Recordings are read row by row and nothing is kept of a row, so they may be long. Of a thinned
/// recording (sim/records/row_thinning.h), quantities of one case are those of all samples; a
/// difference of two cases is looked at where a row stays, and the deviation of the other case from
/// the programmed path is linear from row to row.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/evaluation/case_samples.h"
#include "sim/evaluation/comparison.h"

namespace servomill::sim {

/// A signed quantity at each sample of feed motion.
struct PathSignal {
  std::vector<double> s;       // mm, arc length of the original path, not falling
  std::vector<double> turned;  // 0 to 1, of what rotary axes turn while s stands; 0 where it moves
  std::vector<double> value;   // of the same length, in the unit of the quantity; or none
};

/// Whether path_signal knows this quantity: imposed_curve_residual, trajectory_difference,
/// tool_deviation, following_error.
bool has_path_signal(std::string_view quantity);

/// What the statistic of a quantity is taken over.
/// @param base  the case it is compared with; nullptr if it needs none
/// @pre has_path_signal(spec.name), and both cases have finished
PathSignal path_signal(const QuantitySpec& spec, const CaseData& one, const CaseData* base);

/// A quantity of quantity_info that is none of circles, balls and probes, nor cycle_time or blocks.
struct PathValue {
  double value;           // NaN: nothing of it was recorded
  std::string note = {};  // what is to be known of it
};
/// @pre both cases have finished
PathValue path_value(const QuantitySpec& spec, CaseSamples& samples, const CaseData* base);

}  // namespace servomill::sim
