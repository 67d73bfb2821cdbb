/// Values at equidistant points of up to three axes, as tables in a NC hold them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::strategies {

/// Equidistant points of one axis.
struct GridLine {
  int joint = 0;
  double first = 0.0;      // m
  double spacing = 1.0;    // m
  std::size_t points = 2;  // at least

  double at(std::size_t i) const { return first + static_cast<double>(i) * spacing; }
  double last() const { return at(points - 1); }
};

/// Values at the points of one to three lines that cross; linear in each coordinate between the
/// corners of a cell, constant beyond the ends.
struct GridTable {
  std::vector<GridLine> lines;
  std::vector<Eigen::Vector3d> value;  // m, of X, Y, Z; the first line's points are neighbours

  /// Value at the joints (m, rad) of a machine.
  Eigen::Vector3d at(const Joints& Q) const;
};

/// Calls f(point) for all points of the lines, (i, j, k) of each, the first line's first.
template <class F>
void for_all_points(const std::vector<GridLine>& lines, F f) {
  std::array<std::size_t, kLinearJoints> point{};
  for (std::size_t a = 0; a < lines.size();) {
    f(point);
    for (a = 0; a < lines.size() && ++point[a] == lines[a].points; ++a) point[a] = 0;
  }
}

}  // namespace servomill::strategies
