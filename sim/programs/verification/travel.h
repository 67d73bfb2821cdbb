/// Directions in which the axes of the original travel, for errors that depend on them.
#pragma once

#include <vector>

#include "sim/programs/compensate/correction.h"
#include "sim/programs/verification/original.h"

namespace servomill::sim::programs {

/// The action in pieces in which no axis turns whose errors depend on its direction: itself, unless
/// it is an arc.
std::vector<OriginalAction> pieces_of(const OriginalAction& action, const Correction& correction);

/// Directions behind the action: an axis that stands keeps its own, one that comes from an unknown
/// position has none.
void turn(Directions& directions, const OriginalAction& piece);

}  // namespace servomill::sim::programs
