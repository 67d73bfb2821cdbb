/// Words of a block that decide which positions a program names.
#pragma once

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/axes.h"

namespace servomill::sim::programs {

/// Code of the non-modal group, ten times (G92.1 is 921); -1: the block has none.
int non_modal_code(const controllers::ExecutedBlock& block);

/// The block has a word of the axis, or of X and Y a polar coordinate.
bool names_axis(const controllers::ExecutedBlock& block, Axis axis);

}  // namespace servomill::sim::programs
