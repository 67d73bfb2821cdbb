/// Errors of a machine one by one, as their effects on the tip are measured.
#pragma once

#include "plant/geometry/error_model.h"

namespace servomill::sim::model {

/// So small that effects are proportional to it (m, rad).
inline constexpr double kUnitError = 1e-6;

/// One component or location error of that size, the same everywhere.
plant::ErrorModel unit_error(const plant::ErrorName& name);

}  // namespace servomill::sim::model
