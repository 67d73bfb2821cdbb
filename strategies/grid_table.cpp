#include "strategies/grid_table.h"

#include <algorithm>

namespace servomill::strategies {

Eigen::Vector3d GridTable::at(const Joints& Q) const {
  Eigen::Vector3d corner[1 << kLinearJoints];
  const std::size_t axes = lines.size();
  double share[kLinearJoints];  // of the cell, that has been passed
  std::size_t base = 0, step[kLinearJoints], size = 1;
  for (std::size_t a = 0; a < axes; ++a) {
    const GridLine& line = lines[a];
    const auto last = static_cast<double>(line.points - 1);
    const double u = std::clamp((Q[line.joint] - line.first) / line.spacing, 0.0, last);
    const auto i = std::min(static_cast<std::size_t>(u), line.points - 2);
    share[a] = u - static_cast<double>(i);
    base += i * size;
    step[a] = size;
    size *= line.points;
  }
  for (std::size_t c = 0; c < std::size_t{1} << axes; ++c) {
    std::size_t place = base;
    for (std::size_t a = 0; a < axes; ++a) place += (c >> a & 1U) * step[a];
    corner[c] = value[place];
  }
  for (std::size_t a = axes; a-- > 0;) {  // from corners to the point, axis by axis
    for (std::size_t c = 0; c < std::size_t{1} << a; ++c) {
      corner[c] += share[a] * (corner[c + (std::size_t{1} << a)] - corner[c]);
    }
  }
  return corner[0];
}

}  // namespace servomill::strategies
