/// Groups of readings that contradict all others, and the mistake that would explain it.
#pragma once

#include <functional>
#include <vector>

#include "sim/calibration/adjustment.h"

namespace servomill::sim::calibration {

/// Groups whose numbers agree with all others once they are multiplied by a factor: a sign that is
/// wrong, or a unit.
struct Suspect {
  std::vector<std::size_t> groups;
  double factor = -1.0;
  double squares = 0.0;  // of all whitened residuals, so multiplied
};

/// Tries each group, and all groups of one kind and axis at once; the best explanations.
/// @param squares  sum of squares of whitened residuals of the adjustment of observations
/// @return nothing where the readings agree as well as their uncertainties let expect
std::vector<Suspect> contradictions(const readings::Readings& readings,
                                    const Observations& observations, const Adjustment& found,
                                    const std::function<double(const Observations&)>& squares);

}  // namespace servomill::sim::calibration
