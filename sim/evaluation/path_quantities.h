/// The quantities that are values along the path of a case: largest value, range, mean or rms of
/// deviations and of differences from another case.
///
/// Recordings are read row by row and nothing is kept of a row, so they may be long. Of a thinned
/// recording (sim/records/row_thinning.h), quantities of one case are those of all samples; a
/// difference of two cases is looked at where a row stays, and the deviation of the other case from
/// the programmed path is linear from row to row.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "sim/evaluation/case_samples.h"
#include "sim/evaluation/comparison.h"

namespace servomill::sim {

/// A signed quantity at a sample of feed motion.
struct PathSample {
  double s = 0.0;       // mm, arc length of the original path, not falling
  double turned = 0.0;  // 0 to 1, of what rotary axes turn while s stands; 0 where it moves
  double value = 0.0;   // in the unit of the quantity
};

/// True if there is a PathSignal of this quantity: imposed_curve_residual, trajectory_difference,
/// tool_deviation, following_error.
bool has_path_signal(std::string_view quantity);

/// Samples over which the statistic of a quantity is taken, one by one; nothing is kept of them.
class PathSignal {
 public:
  /// @param one, base  the recordings must outlive it; base: the case it is compared with, nullptr
  ///                   if it needs none
  /// @pre has_path_signal(spec.name), and both cases have finished
  PathSignal(const QuantitySpec& spec, const CaseData& one, const CaseData* base);
  PathSignal(PathSignal&&) noexcept;
  ~PathSignal();

  /// Samples; 0 also if what it takes was not recorded.
  std::size_t size() const;
  /// The next sample; false behind the last.
  bool next(PathSample& sample);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// A quantity of quantity_info that is none of circles, balls and probes, nor cycle_time or blocks.
struct PathValue {
  double value;           // NaN: nothing of it was recorded
  std::string note = {};  // what is to be known of it
};
/// @pre both cases have finished
PathValue path_value(const QuantitySpec& spec, CaseSamples& samples, const CaseData* base);

}  // namespace servomill::sim
