#include "sim/metrology/sphere_fit.h"

#include <cmath>
#include <vector>

#include "sim/metrology/circle_fit.h"
#include "sim/metrology/plane_fit.h"
#include "sim/metrology/round_fit.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::metrology {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Vector6 = Eigen::Vector<double, 6>;

// Gauss-Newton over shifts of the centre, tilts of the normal and the radius, in units of the
// radius. A point at (x, y, z) in the circle's frame is rho - r = |(x, y)| - r and z away from it.
Circle3 refined(Points3 points, Circle3 circle) {
  constexpr int kMaxSteps = 50;     // about five are needed
  constexpr double kStill = 1e-14;  // shorter steps are rounding
  for (int step = 0; step < kMaxSteps; ++step) {
    const double r = circle.radius;
    const Vector3d n = circle.normal, u = across(n), v = n.cross(u);
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Vector6 right = Vector6::Zero();
    for (const Vector3d& p : points) {
      const Vector3d q = (p - circle.centre) / r;
      const double x = u.dot(q), y = v.dot(q), z = n.dot(q), rho = std::hypot(x, y);
      Vector6 radial, axial;
      radial << x / rho, y / rho, 0.0, z * x / rho, z * y / rho, 1.0;
      axial << 0.0, 0.0, 1.0, -x, -y, 0.0;
      normal += radial * radial.transpose() + axial * axial.transpose();
      right += radial * (rho - 1.0) + axial * z;
    }
    const Vector6 s = numerics::solve_symmetric(normal, right);
    circle.centre += r * (s[0] * u + s[1] * v + s[2] * n);
    circle.normal = (n + s[3] * u + s[4] * v).normalized();
    circle.radius += r * s[5];
    if (s.norm() <= kStill) break;
  }
  return circle;
}

}  // namespace

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
  return refined(points, {plane->point + circle.centre.x() * u + circle.centre.y() * v,
                          plane->normal, circle.radius});
}

}  // namespace servomill::sim::metrology
