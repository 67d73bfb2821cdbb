/// Cylinders through measured points: least squares.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "sim/metrology/points.h"

namespace servomill::sim::metrology {

struct Cylinder {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       // of the axis, next to the points' mean
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // of the axis, unit
  double radius = 0.0;

  /// Signed: positive outside.
  double distance(const Eigen::Vector3d& p) const;
};

/// The cylinder with the smallest sum of (distance from the axis - radius)^2, by Gauss-Newton in
/// the frame of the cylinder reached so far, where the distance rho = |(x, y)| of p = (x, y, z)
/// changes by
/// -(x, y) / rho . (shift + z slope). The steps are damped until the sum hardly falls any more,
/// then full until rounding stops them, so that the gradient vanishes and the start does not
/// matter.
/// @param near  direction of the axis (any length) from which the search starts, and its sign
/// nullopt: the points do not determine one (fewer than five, one section only, a plane ...)
/// Source: A. B. Forbes, Least-squares best-fit geometric elements, NPL Report DITC 140/89, 1989.
std::optional<Cylinder> least_squares_cylinder(Points3 points, const Eigen::Vector3d& near);

/// The same with no direction known: from the best of directions all over the half-sphere, each
/// with the algebraic circle of the points along it. The direction's largest component is positive.
std::optional<Cylinder> least_squares_cylinder(Points3 points);

}  // namespace servomill::sim::metrology
