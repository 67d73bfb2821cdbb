/// Errors of a machine while one of its axes travels in one direction, or is the only one to move.
#pragma once

#include "plant/geometry/error_model.h"

namespace servomill::plant {

/// The component errors of that axis are those of its direction of travel; of the other axes,
/// reversals keep their mean.
/// @param direction  1: up, -1: down, 0: the mean
ErrorModel travelling(const ErrorModel& errors, Axis axis, double direction);

/// The component errors of that axis are functions of its own coordinate only, those of its grids
/// where the other axes are held at q; the errors of the other axes stay as they are.
/// @param q  coordinates of all axes (6; m, rad)
ErrorModel held(const ErrorModel& errors, Axis axis, const AxisWords& q);

}  // namespace servomill::plant
