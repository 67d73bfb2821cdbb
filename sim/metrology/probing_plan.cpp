#include "sim/metrology/probing_plan.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

namespace servomill::sim::metrology {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kSameAngle = 1e-9;  // rad

double share(int i, int points) { return points > 1 ? static_cast<double>(i) / (points - 1) : 0.5; }

void add_ring(Feature& feature, double z, bool outside, const ArcOfPoints& arc) {
  const double sweep = arc.to - arc.from;
  const bool closed = std::abs(sweep - kTurn) < kSameAngle;
  const int steps = closed ? arc.points : arc.points - 1;
  for (int i = 0; i < arc.points; ++i) {
    const double angle = arc.from + (steps > 0 ? sweep * i / steps : 0.0);
    const Eigen::Vector3d radial(std::cos(angle), std::sin(angle), 0.0);
    const Eigen::Vector3d foot(feature.origin.x(), feature.origin.y(), z);
    feature.targets.push_back({foot + feature.radius * radial, outside ? radial : -radial});
  }
}

}  // namespace

std::string_view name_of(FeatureKind kind) {
  constexpr std::array<std::string_view, 6> kNames = {"line",     "plane", "circle",
                                                      "cylinder", "notch", "points"};
  return kNames[static_cast<std::size_t>(kind)];
}

Feature line_feature(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                     const Eigen::Vector3d& normal, int points) {
  Feature out;
  out.kind = FeatureKind::line;
  out.origin = from;
  out.length = (to - from).norm();
  out.direction = (to - from) / out.length;
  out.normal = normal;
  for (int i = 0; i < points; ++i) {
    out.targets.push_back({from + share(i, points) * (to - from), normal});
  }
  return out;
}

Feature plane_feature(const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                      const Eigen::Vector3d& v, const Eigen::Vector3d& normal, int points_u,
                      int points_v) {
  Feature out;
  out.kind = FeatureKind::plane;
  out.origin = corner;
  out.normal = normal;
  for (int j = 0; j < points_v; ++j) {
    for (int i = 0; i < points_u; ++i) {
      out.targets.push_back({corner + share(i, points_u) * u + share(j, points_v) * v, normal});
    }
  }
  return out;
}

Feature circle_feature(const Eigen::Vector3d& centre, double radius, bool outside,
                       const ArcOfPoints& arc) {
  Feature out;
  out.kind = FeatureKind::circle;
  out.origin = centre;
  out.radius = radius;
  add_ring(out, centre.z(), outside, arc);
  return out;
}

Feature cylinder_feature(const Eigen::Vector3d& centre, double radius, bool outside,
                         const ArcOfPoints& arc, double to_z, int rings) {
  Feature out;
  out.kind = FeatureKind::cylinder;
  out.origin = centre;
  out.radius = radius;
  out.length = std::abs(to_z - centre.z());
  for (int ring = 0; ring < rings; ++ring) {
    add_ring(out, centre.z() + share(ring, rings) * (to_z - centre.z()), outside, arc);
  }
  return out;
}

Feature notch_feature(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double width,
                      int points) {
  Feature out;
  out.kind = FeatureKind::notch;
  out.origin = from;
  out.length = (to - from).norm();
  out.direction = (to - from) / out.length;
  const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(out.direction);
  for (const double side : {1.0, -1.0}) {
    for (int i = 0; i < points; ++i) {
      const Eigen::Vector3d middle = from + share(i, points) * (to - from);
      out.targets.push_back({middle + 0.5 * side * width * left, -side * left});
    }
  }
  return out;
}

}  // namespace servomill::sim::metrology
