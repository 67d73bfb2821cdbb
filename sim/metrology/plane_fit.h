/// Planes through measured points: least squares.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "sim/metrology/points.h"

namespace servomill::sim::metrology {

struct Plane {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit

  /// Signed: positive on the side of the normal.
  double distance(const Eigen::Vector3d& p) const;
};

/// The plane with the smallest sum of squared distances at right angles to it.
/// @param outside  the side to which the normal points (any length)
/// nullopt: the points lie in one place or on a line
std::optional<Plane> least_squares_plane(Points3 points, const Eigen::Vector3d& outside);

/// The shortest rotation that turns one direction into another, as a rotation vector (rad). For a
/// plane z = a x + b y and small slopes it is (b, -a, 0) from the Z axis to the plane's normal.
/// @param from, to  unit, not opposite
Eigen::Vector3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace servomill::sim::metrology
