/// The solutions of inverse kinematics as branches that a motion follows: which of them leave a
/// singular direction, and where the travel of an axis cuts one off.
#pragma once

#include <optional>
#include <vector>

#include "plant/kinematics/inverse.h"

namespace servomill::plant {

/// Joints on every branch at a pose just off a singular direction, the nearest first: both
/// solutions, and each with the axis that was free a full turn before and behind. Only what lies
/// within the travel.
/// @param Q_near  joints in the singular direction (5; m, rad)
std::vector<Joints> departures(const InverseKinematics& inverse, const ToolPose& P,
                               const Eigen::Vector3d& p_ST, const Joints& Q_near);

/// The joint that is at its end where a motion cannot go on continuously from Q to the pose P next
/// to it; nullopt if no travel is in its way.
std::optional<int> joint_at_its_end(const InverseKinematics& inverse, const ToolPose& P,
                                    const Eigen::Vector3d& p_ST, const Joints& Q);

}  // namespace servomill::plant
