/// Rewritten program: the path is cut into short linear blocks and every point displaced, so that
/// the correction takes the whole way through the NC, feed-forward included.
///
/// Moves under tool-centre-point control become blocks of the axes: with the tip p(t) and the tool
/// axis k(t) (or the rotary axes) as programmed, Q(t) the ideal inverse, and d what brings tip and
/// tool axis to where they belong (strategies/pose_compensation.h),
///
///     Q_block(t) = Q(t) + d(Q(t)),   chords within the tolerances,   time t / feed of the tip
///     (G93)
///
/// so that the NC needs no tool-centre-point control any more. Rotary axes take the orientation
/// part, linear axes the rest. Moves in a tilted work plane are refused.
#pragma once

#include <stdexcept>

#include "strategies/entry.h"

namespace servomill::strategies {

/// A rewritten program larger than any memory.
class TooManyBlocks : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

Entry gcode_entry();

}  // namespace servomill::strategies
