/// Rewritten program: the path is cut into short linear blocks and every point displaced, so that
/// the correction takes the whole way through the NC, feed-forward included.
#pragma once

#include "strategies/registry.h"

namespace servomill::strategies {

Entry gcode_entry();

}  // namespace servomill::strategies
