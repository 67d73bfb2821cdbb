/// Straight lines through measured points: least squares.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "sim/metrology/points.h"

namespace servomill::sim::metrology {

/// A line of a plane.
struct Line2 {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  // unit

  /// Signed: positive on the left of the direction.
  double distance(const Eigen::Vector2d& p) const;
};

/// A line of space.
struct Line3 {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit

  /// Distance of a point from the line, >= 0.
  double distance(const Eigen::Vector3d& p) const;
};

/// The line with the smallest sum of squared distances at right angles to it: through the mean,
/// along the direction of largest extent, from the first point towards the last.
/// nullopt: all points are in one place
std::optional<Line2> least_squares_line(Points2 points);
std::optional<Line3> least_squares_line(Points3 points);

}  // namespace servomill::sim::metrology
