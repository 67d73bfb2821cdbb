/// Values at points of up to three axes, as tables in a NC hold them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::strategies {

/// Points of one axis, equidistant unless their positions are given.
struct GridLine {
  int joint = 0;
  double first = 0.0;                  // m
  double spacing = 1.0;                // m
  std::size_t points = 2;              // at least
  std::vector<double> positions = {};  // m, ascending; empty: equidistant

  double at(std::size_t i) const {
    return positions.empty() ? first + static_cast<double>(i) * spacing : positions[i];
  }
  double last() const { return at(points - 1); }

  /// The interval that holds a coordinate, by its first point, and the share of it that has been
  /// passed; beyond the ends the share is 0 or 1.
  struct Place {
    std::size_t interval = 0;
    double share = 0.0;
  };
  Place place_of(double q) const;
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
