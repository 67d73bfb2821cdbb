/// Stability of an axis' servo loops as they are sampled: before a run, not after it went wrong.
#pragma once

#include <memory>

#include "plant/vocabulary/ticks.h"
#include "sim/model/forward.h"

namespace servomill::sim::frequency {

/// The machine without what is not linear: friction other than viscous, backlash, cogging, constant
/// load, limits, quantisation.
model::MachineSettings linearised(const model::MachineSettings& machine);

/// The same for callers that need no complete MachineSettings.
std::shared_ptr<const model::MachineSettings> shared_linearised(
    const model::MachineSettings& machine);

/// Largest eigenvalue magnitude of the linear closed loop of one axis over one common multiple of
/// its periods (position, velocity and current loop with drive, reading delay included); below 1
/// the axis settles. Limits, quantisation and feed-forward play no part.
/// @param reading_delay  ticks between the scale and what the position loop reads
double spectral_radius(const model::MachineSettings& machine, int joint, Tick reading_delay);

}  // namespace servomill::sim::frequency
