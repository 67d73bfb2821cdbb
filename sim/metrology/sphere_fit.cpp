#include "sim/metrology/sphere_fit.h"

#include <Eigen/Dense>
#include <vector>

#include "sim/metrology/circle_fit.h"
#include "sim/metrology/plane_fit.h"
#include "sim/metrology/round_fit.h"

namespace servomill::sim {

using Eigen::Vector2d;
using Eigen::Vector3d;

double Sphere::distance(const Vector3d& p) const { return (p - centre).norm() - radius; }

double Circle3::distance(const Vector3d& p) const {
  return normal.cross(p - centre).norm() - radius;
}

std::optional<Sphere> least_squares_sphere(Points3 points) {
  if (points.size() < 4 || !principal_axes(points).span_directions(3)) return std::nullopt;
  const Round<3> round = geometric_round<3>(points);
  return Sphere{round.centre, round.radius};
}

std::optional<Circle3> least_squares_circle(Points3 points, const Vector3d& axis) {
  if (points.size() < 3) return std::nullopt;
  const auto plane = least_squares_plane(points, axis);
  if (!plane) return std::nullopt;
  const Vector3d u = across(plane->normal), v = plane->normal.cross(u);
  std::vector<Vector2d> feet;
  feet.reserve(points.size());
  for (const Vector3d& p : points) {
    feet.emplace_back(u.dot(p - plane->point), v.dot(p - plane->point));
  }
  const Circle circle = least_squares_circle(feet);
  return Circle3{plane->point + circle.centre.x() * u + circle.centre.y() * v, plane->normal,
                 circle.radius};
}

}  // namespace servomill::sim
