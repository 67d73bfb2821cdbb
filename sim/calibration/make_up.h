/// Readings made up: what instruments would have shown on a machine with known errors.
#pragma once

#include <cstdint>

#include "plant/geometry/error_model.h"
#include "sim/readings/readings.h"

namespace servomill::sim::calibration {

/// Uncertainty of a reading that is made up where the group says "estimate".
inline constexpr double kMadeUpUncertainty = 1e-6;  // m, rad

/// Replaces the deviations of all rows (of spheres and touches: the linear joints) by those that
/// the machine with these errors would give, with noise of the stated uncertainties, unknowns of
/// the set-up drawn from theirs, or of some ten micrometres where nothing is known of them. Single
/// touches are right to second order in what shifts the stylus: (30 um)^2 over 30 mm.
/// @throws InputError if a sphere cannot be reached
void make_up(readings::Readings& readings, const plant::MachineChain& chain,
             const plant::ErrorModel& errors, std::uint64_t seed);

}  // namespace servomill::sim::calibration
