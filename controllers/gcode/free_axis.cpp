#include "controllers/gcode/free_axis.h"

#include <algorithm>

#include "plant/kinematics/branches.h"

namespace servomill::controllers {
namespace {

constexpr double kJustOff = 1e-7;  // rad; so near to a singular direction axes begin to tilt
constexpr int kMaxHalvings = 20;

ToolPose just_off(const plant::StraightToolPath& path) {
  return path.at(std::min(1.0, kJustOff / path.angle()));
}

}  // namespace

double rotation_between(const Joints& Q_0, const Joints& Q_1) {
  return (Q_1 - Q_0).tail<kJoints - kLinearJoints>().cwiseAbs().maxCoeff();
}

std::vector<Joints> FreeAxis::branches(const plant::StraightToolPath& path,
                                       const Joints& Q_near) const {
  return plant::departures(inverse_, just_off(path), p_ST_, Q_near);
}

// The joints of a branch, where the direction is still singular.
std::optional<Joints> FreeAxis::on_branch(const ToolPose& P, const Joints& branch) const {
  const plant::JointSolution found = inverse_.nearest(P, p_ST_, branch);
  return found.is_reached() ? std::optional(found.Q) : std::nullopt;
}

// True if a branch arrives without changing to another in the singular direction.
bool FreeAxis::arrives(const plant::StraightToolPath& path, const Joints& branch) const {
  return linearised({just_off(path), path.at(1.0)}, branch).is_complete;
}

std::optional<Joints> FreeAxis::before_leaving(const std::vector<ToolPose>& upright,
                                               const ToolPose& next, const Joints& Q) const {
  const plant::StraightToolPath path(upright.back(), next);
  for (const Joints& branch : branches(path, Q)) {
    const auto Q_first = on_branch(upright.front(), branch);
    const bool stays_free =
        Q_first && std::all_of(upright.begin(), upright.end(), [&](const ToolPose& P) {
          return on_branch(P, *Q_first).has_value();
        });
    if (stays_free && arrives(path, branch)) return Q_first;
  }
  return std::nullopt;
}

std::optional<FreeAxis::Departure> FreeAxis::departure(const plant::StraightToolPath& path,
                                                       const ToolPose& here,
                                                       const Joints& Q) const {
  if (path.angle() < kSameAxis || !inverse_.nearest(here, p_ST_, Q).is_singular) return {};
  for (const Joints& branch : branches(path, Q)) {
    const auto Q_branch = on_branch(here, branch);
    if (!Q_branch || !arrives(path, branch)) continue;
    Departure out;
    if (rotation_between(Q, *Q_branch) > kSameAngle &&
        !rotate_in_place(here, Q, *Q_branch, kMaxHalvings, out.rotation)) {
      continue;
    }
    out.path = linearised(path, *Q_branch);
    if (out.path.is_complete) return out;
  }
  return {};
}

// Chords from Q_0 to Q_1 on which the tip stays here.
bool FreeAxis::rotate_in_place(const ToolPose& here, const Joints& Q_0, const Joints& Q_1,
                               int halvings_left, std::vector<Joints>& out) const {
  const Joints middle = 0.5 * (Q_0 + Q_1);
  const Eigen::Vector3d tip = plant::forward(inverse_.chain(), middle, p_ST_).p_WT;
  if ((tip - here.p_WT).norm() <= tolerance_.tip || halvings_left == 0) {
    out.push_back(Q_1);
    return true;
  }
  const auto between = on_branch(here, middle);
  return between && rotate_in_place(here, Q_0, *between, halvings_left - 1, out) &&
         rotate_in_place(here, *between, Q_1, halvings_left - 1, out);
}

}  // namespace servomill::controllers
