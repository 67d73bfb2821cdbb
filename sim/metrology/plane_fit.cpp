#include "sim/metrology/plane_fit.h"

#include <Eigen/Geometry>
#include <cmath>

namespace servomill::sim::metrology {

double Plane::distance(const Eigen::Vector3d& p) const { return normal.dot(p - point); }

std::optional<Plane> least_squares_plane(Points3 points, const Eigen::Vector3d& outside) {
  if (points.empty()) return std::nullopt;
  const PrincipalAxes<3> axes = principal_axes(points);
  if (!axes.span_directions(2)) return std::nullopt;
  Plane plane{axes.mean, axes.axes.col(2)};
  if (plane.normal.dot(outside) < 0.0) plane.normal *= -1.0;
  return plane;
}

Eigen::Vector3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d cross = from.cross(to);
  const double sine = cross.norm();
  if (sine == 0.0) return Eigen::Vector3d::Zero();
  return std::atan2(sine, from.dot(to)) / sine * cross;
}

}  // namespace servomill::sim::metrology
