#include "sim/metrology/probed_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace servomill::sim::metrology {
namespace {

using Eigen::Vector3d;

constexpr double kHalfStep = 1e-6;  // m, of differences

// Distance from the intersection of two sets, by those from each: the corner is round.
double of_intersection(double a, double b) {
  if (a > 0.0 && b > 0.0) return std::hypot(a, b);
  return std::max(a, b);
}

double along(double from, double to, double z) {
  return std::abs(z - 0.5 * (from + to)) - 0.5 * (to - from);
}

double distance(const plant::StockBox& box, const Vector3d& p) {
  Vector3d d = p - 0.5 * (box.from + box.to);
  d.head<2>() = Eigen::Rotation2Dd(-box.turned) * d.head<2>();
  const Vector3d beyond = d.cwiseAbs() - 0.5 * (box.to - box.from);
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

double distance(const plant::StockCylinder& cylinder, const Vector3d& p) {
  return of_intersection((p.head<2>() - cylinder.centre).norm() - cylinder.radius,
                         along(cylinder.from, cylinder.to, p.z()));
}

double distance(const plant::StockSolid& solid, const Vector3d& p) {
  return std::visit([&](const auto& one) { return distance(one, p); }, solid);
}

double distance(const std::shared_ptr<const TriangleMesh>& mesh, const Vector3d& p) {
  return mesh->closest(p).distance;
}

double distance(const SphereBody& sphere, const Vector3d& p) {
  return (p - sphere.centre).norm() - sphere.radius;
}

double distance(const PlaneBody& plane, const Vector3d& p) {
  return plane.normal.dot(p - plane.point);
}

double distance(const BoreBody& bore, const Vector3d& p) {
  return of_intersection(bore.radius - (p.head<2>() - bore.centre).norm(),
                         along(bore.from, bore.to, p.z()));
}

double distance(const DisplacedBody& body, const Vector3d& p) {
  const Vector3d own = body.motion.inverse() * p;
  return std::visit([&](const auto& one) { return distance(one, own); }, body.body);
}

}  // namespace

double signed_distance(const ProbedBody& body, const Vector3d& place) {
  return std::visit([&](const auto& one) { return distance(one, place); }, body);
}

double signed_distance(const std::vector<ProbedBody>& bodies, const Vector3d& place) {
  double least = std::numeric_limits<double>::infinity();
  for (const ProbedBody& body : bodies) least = std::min(least, signed_distance(body, place));
  return least;
}

Vector3d outward_normal(const std::vector<ProbedBody>& bodies, const Vector3d& place) {
  Vector3d out;
  for (int k = 0; k < 3; ++k) {
    const Vector3d step = kHalfStep * Vector3d::Unit(k);
    out[k] = signed_distance(bodies, place + step) - signed_distance(bodies, place - step);
  }
  return out.norm() > 0.0 ? Vector3d(out.normalized()) : Vector3d(Vector3d::UnitZ());
}

}  // namespace servomill::sim::metrology
