/// Visits all points of a grid.
#pragma once

#include <cstddef>

#include "plant/geometry/grid_function.h"

namespace servomill::sim::tables {

/// Calls f(q) at every combination of positions from an argument on, the last one the fastest.
/// @param q  coordinates of all axes (6; m, rad); those that are no arguments stay
template <class F>
void for_all_points(const plant::GridPoints& points, std::size_t argument, AxisWords& q,
                    const F& f) {
  if (argument == points.axes.size()) return f(q);
  for (const double position : points.at[argument]) {
    q[index_of(points.axes[argument])] = position;
    for_all_points(points, argument + 1, q, f);
  }
}

}  // namespace servomill::sim::tables
