#include "sim/calibration/touched_spheres.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/metrology/location_errors.h"
#include "sim/metrology/sphere_fit.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::calibration {
namespace {

using Eigen::Vector3d;
using readings::Group;

constexpr double kSameAngle = 1e-6;     // rad
constexpr double kPlausible = 1e-3;     // m, between radii fitted and nominal
constexpr std::size_t kFreeRadius = 5;  // touches from which on the radius is fitted, too
constexpr int kSteps = 20;

bool is_same_pose(const readings::Reading& a, const readings::Reading& b) {
  return a.sphere == b.sphere && (a.Q - b.Q).tail<kJoints - kLinearJoints>().norm() < kSameAngle;
}

// The centre of a sphere of known radius near a place.
Vector3d centre_near(const std::vector<Vector3d>& points, double radius, Vector3d centre) {
  for (int step = 0; step < kSteps; ++step) {
    Eigen::MatrixXd A(points.size(), 3);
    Eigen::VectorXd b(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3d arm = points[i] - centre;
      A.row(Eigen::Index(i)) = arm.normalized();
      b[Eigen::Index(i)] = arm.norm() - radius;
    }
    centre += Vector3d(numerics::least_squares(A, b));
  }
  return centre;
}

// @param away  unit vector from the spindle into the sphere
Vector3d centre_of(const std::vector<Vector3d>& points, double radius, const Vector3d& away) {
  if (points.size() >= kFreeRadius) {
    const auto sphere = metrology::least_squares_sphere(points);
    if (sphere && std::abs(sphere->radius - radius) < kPlausible) return sphere->centre;
  }
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points) mean += point;
  return centre_near(points, radius,
                     mean / static_cast<double>(points.size()) + 0.5 * radius * away);
}

}  // namespace

TouchedSpheres touched_spheres(const Group& group, const plant::MachineChain& chain) {
  TouchedSpheres out;
  out.centre.assign(group.spheres.size(), Vector3d::Zero());
  std::vector<int> poses(group.spheres.size(), 0);
  out.n_W.assign(group.rows.size(), Vector3d::Zero());
  std::vector<bool> done(group.rows.size(), false);
  for (std::size_t first = 0; first < group.rows.size(); ++first) {
    if (done[first]) continue;
    const readings::Reading& pose = group.rows[first];
    std::vector<std::size_t> rows;
    std::vector<Vector3d> tips;
    for (std::size_t row = first; row < group.rows.size(); ++row) {
      if (!is_same_pose(pose, group.rows[row])) continue;
      rows.push_back(row);
      tips.push_back(plant::forward(chain, group.rows[row].Q, group.p_ST).p_WT);
      done[row] = true;
    }
    if (rows.size() < 3) {
      throw InputError(
          {group.file, pose.line},
          fmt::format("sphere {} is touched {} at these angles of the rotary axes; "
                      "at least three touches are required",
                      group.spheres[pose.sphere], rows.size() == 1 ? "once" : "twice"));
    }
    const Vector3d away = -metrology::R_WS(chain, pose.Q).col(2);
    const Vector3d centre = centre_of(tips, group.radius, away);
    out.centre[pose.sphere] += centre;
    ++poses[pose.sphere];
    for (std::size_t k = 0; k < rows.size(); ++k) {
      out.n_W[rows[k]] = (tips[k] - centre).normalized();
    }
  }
  for (std::size_t k = 0; k < poses.size(); ++k) out.centre[k] /= std::max(poses[k], 1);
  return out;
}

}  // namespace servomill::sim::calibration
