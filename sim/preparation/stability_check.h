/// Refuses gains with which an axis diverges, and says which one to lower.
#pragma once

#include "plant/vocabulary/ticks.h"
#include "sim/model/forward.h"

namespace servomill::sim::preparation {

struct PreparationCache;

/// Largest eigenvalue magnitude of the closed loop of one axis (sim/frequency/stability.h).
/// @param linear  linearised(machine)
/// @param cache   may be nullptr
double spectral_radius(const model::MachineSettings& linear, int joint, Tick reading_delay,
                       PreparationCache* cache);

/// Checks every axis of a machine, unless nc.check_stability says otherwise.
/// @param reading_delay  ticks between the scale and what the position loop reads
/// @param cache          may be nullptr
/// @throws InputError with one fault for each unstable axis
void check_stability(const model::MachineSettings& machine, Tick reading_delay,
                     PreparationCache* cache);

}  // namespace servomill::sim::preparation
