/// Spheres and circles of space through measured points: least squares.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "sim/metrology/points.h"

namespace servomill::sim::metrology {

struct Sphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.0;

  /// Signed: positive outside.
  double distance(const Eigen::Vector3d& p) const;
};

/// A circle in a plane of space.
struct Circle3 {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit
  double radius = 0.0;

  /// Signed distance, within the plane, of a point's foot: positive outside.
  double distance(const Eigen::Vector3d& p) const;
};

/// The sphere with the smallest sum of squared distances.
/// nullopt: the points lie in a plane
std::optional<Sphere> least_squares_sphere(Points3 points);

/// The circle with the smallest sum of squared distances in space, those within its plane and those
/// from it: by Gauss-Newton from the least-squares plane and the circle of the points' feet in it,
/// which is nearly the same.
/// @param axis  the side to which the normal points (any length)
/// nullopt: the points lie on a line, or in one place
std::optional<Circle3> least_squares_circle(Points3 points, const Eigen::Vector3d& axis);

}  // namespace servomill::sim::metrology
