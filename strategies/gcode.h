/// Rewritten program: the path is cut into short linear blocks and every point displaced by the
/// identified errors, so that the correction takes the whole way through the NC, feed-forward
/// included (strategies/displaced_blocks.h). Rotary axes take the orientation part, linear axes the
/// rest (strategies/pose_compensation.h).
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry gcode_entry();

}  // namespace servomill::strategies
