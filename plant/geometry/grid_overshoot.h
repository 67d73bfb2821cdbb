/// Cubic grids that leave the range of their values between the positions.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "plant/geometry/grid_function.h"

namespace servomill::plant {

/// The farthest that a grid goes beyond the values at two neighbouring positions of one axis.
struct GridOvershoot {
  double beyond = 0.0;          // m, rad
  std::size_t argument = 0;     // axis along which both are neighbours
  double from = 0.0, to = 0.0;  // m, rad; its positions
  std::vector<double> at;       // m, rad; of all axes
};

/// Along the edges of the cells, at their quarters. A smooth curve has its extremes between the
/// positions, too: overshoot below a tenth of the range of all values does not count, which is that
/// of a sine with five positions a period.
/// @return none of a linear grid
std::optional<GridOvershoot> overshoot_of(const GridFunction& grid);

}  // namespace servomill::plant
