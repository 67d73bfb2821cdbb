/// Information that readings hold on the errors of a machine.
#pragma once

#include <Eigen/Core>

#include "sim/calibration/error_effects.h"
#include "sim/readings/readings.h"

namespace servomill::sim::calibration {

/// J'WJ - J'WS (S'WS + known)^-1 S'WJ: effects J of the errors, S of the set-ups, which are taken
/// out. Of groups without a stated uncertainty, as if it were 1 um or 1 urad.
/// @param effects  of unknowns without set-ups
Eigen::MatrixXd information_of(const readings::Readings& readings, const plant::MachineChain& chain,
                               const ErrorEffects& effects);

}  // namespace servomill::sim::calibration
