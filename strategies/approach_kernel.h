/// Limits of a virtual encoder, of eight runs at once.
#pragma once

#include <cstddef>

#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/simd.h"

namespace servomill::strategies {

/// The value that is nearest within limits, without references: so that lanes go through registers.
inline double within(double value, double least, double most) {
  const double above = value < least ? least : value;
  return most < above ? most : above;
}
inline double limited(double value, double most) { return within(value, -most, most); }

/// The value that comes next: what is wanted, limited in size, approached by a limited change.
inline double approached(double wanted, double most, double most_change, double value) {
  return within(limited(wanted, most), value - most_change, value + most_change);
}

/// approached(), of `count` joints of eight runs, with its bits: the next values replace `values`.
/// @param most, most_change  of each joint
using Approach = void (*)(const double* most, const double* most_change, std::size_t count,
                          const LaneArray* wanted, LaneArray* values);

/// For the instruction set of this machine.
Approach approach_in_lanes();

/// That of one level.
template <SimdLevel level>
Approach make_approach();

}  // namespace servomill::strategies
