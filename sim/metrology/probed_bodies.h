/// Bodies that a touch probe meets, as signed distances from their surfaces.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <variant>
#include <vector>

#include "plant/cutting/stock.h"
#include "sim/metrology/triangle_mesh.h"

namespace servomill::sim::metrology {

/// A calibrated sphere.
struct SphereBody {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // m
  double radius = 0.0;                               // m
};

/// Everything behind a plane.
struct PlaneBody {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, out of the body
};

/// A plate without end, with a bore along Z through it: a ring gauge.
struct BoreBody {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // m
  double radius = 0.0;                               // m
  double from = 0.0, to = 0.0;                       // m, in Z
};

/// A solid or a mesh that lies displaced: p = motion p_own.
struct DisplacedBody {
  std::variant<plant::StockSolid, std::shared_ptr<const TriangleMesh>> body;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
};

using ProbedBody = std::variant<SphereBody, PlaneBody, BoreBody, DisplacedBody>;

/// Distance (m) of a place from the surface, negative inside. Exact outside, where it changes by
/// at most the way that the place goes; of meshes and convex solids inside, too.
double signed_distance(const ProbedBody& body, const Eigen::Vector3d& place);

/// The same of a union: the least of all; infinite without bodies.
double signed_distance(const std::vector<ProbedBody>& bodies, const Eigen::Vector3d& place);

/// Unit normal of the surfaces of equal distance, out of the bodies: by central differences over
/// 2 um, so that it is right to 1e-6 rad for styli of millimetres.
Eigen::Vector3d outward_normal(const std::vector<ProbedBody>& bodies, const Eigen::Vector3d& place);

}  // namespace servomill::sim::metrology
