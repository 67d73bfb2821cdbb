#include "strategies/grid_table.h"

#include <algorithm>

namespace servomill::strategies {

GridLine::Place GridLine::place_of(double q) const {
  if (positions.empty()) {
    const double u = std::clamp((q - first) / spacing, 0.0, static_cast<double>(points - 1));
    const auto i = std::min(static_cast<std::size_t>(u), points - 2);
    return {i, u - static_cast<double>(i)};
  }
  const auto next = std::upper_bound(positions.begin() + 1, positions.end() - 1, q);
  const auto i = static_cast<std::size_t>(next - positions.begin()) - 1;
  return {i, std::clamp((q - positions[i]) / (positions[i + 1] - positions[i]), 0.0, 1.0)};
}

Eigen::Vector3d GridTable::at(const Joints& Q) const {
  Eigen::Vector3d corner[1 << kLinearJoints];
  const std::size_t axes = lines.size();
  double share[kLinearJoints];  // of the cell, that has been passed
  std::size_t base = 0, step[kLinearJoints], size = 1;
  for (std::size_t a = 0; a < axes; ++a) {
    const GridLine& line = lines[a];
    const GridLine::Place place = line.place_of(Q[line.joint]);
    share[a] = place.share;
    base += place.interval * size;
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
