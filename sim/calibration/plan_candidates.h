/// Set-ups that instruments can be given on a machine.
#pragma once

#include <vector>

#include "sim/calibration/plan.h"
#include "sim/model/forward.h"

namespace servomill::sim::calibration {

/// All of them: lines at nine places of the other axes, circles, squares and spheres, each at every
/// tool length. Uncertainties and times are those of usual instruments and assumed; they stand in
/// sim/calibration/README.md.
std::vector<PlannedSetUp> plan_candidates(const model::MachineSettings& machine,
                                          const PlanSettings& settings);

}  // namespace servomill::sim::calibration
