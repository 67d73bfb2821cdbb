/// Errors of a machine one axis of which travels on and on in one direction.
#pragma once

#include "plant/geometry/error_model.h"

namespace servomill::plant {

/// The component errors of that axis are those of its direction of travel; of the other axes,
/// reversals keep their mean.
/// @param direction  1: up, -1: down, 0: the mean
ErrorModel travelling(const ErrorModel& errors, Axis axis, double direction);

}  // namespace servomill::plant
