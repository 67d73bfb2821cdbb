/// Errors over two axes that a calibration looks for.
#pragma once

#include <vector>

#include "sim/calibration/calibration.h"

namespace servomill::sim::calibration {

/// Grids that the settings ask for. Their knots are where the lines of their axis have been read,
/// or as many as are asked for, equally spaced between these.
/// @throws InputError where the readings are at one position of an axis, or an axis is endless
std::vector<SoughtGrid> sought_grids(const readings::Readings& readings,
                                     const Observations& observations,
                                     const plant::MachineChain& chain,
                                     const CalibrationSettings& settings);

}  // namespace servomill::sim::calibration
