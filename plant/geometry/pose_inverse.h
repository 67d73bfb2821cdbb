/// All joints of a machine with errors: those that put the true tip and the true tool axis where
/// they are asked to be.
///
/// Newton's method in two parts, so that the tip is met also where the tool axis cannot be. With
/// linear joints l, rotary joints r and the misses s_p, s_k of tip and axis,
///
///     J_pl dl + J_pr dr = s_p        dl = J_pl^+ (s_p - J_pr dr)
///     J_kl dl + J_kr dr = s_k        (J_kr - J_kl J_pl^+ J_pr) dr = s_k - J_kl J_pl^+ s_p
///
/// the latter by least squares and, where one angle does not matter, by the smallest step. It
/// begins at the ideal joints for the pose less what the errors do there, which leaves to Newton
/// what is second order, and near a singular direction finds the angle by itself.
#pragma once

#include "plant/geometry/volumetric.h"
#include "plant/kinematics/inverse.h"

namespace servomill::plant {

struct TrueJoints {
  Joints Q = Joints::Zero();     // m, rad
  Reach reach = Reach::reached;  // by the machine with its errors; where not, Q comes closest:
                                 // the tip first, then the tool axis
  bool is_singular = false;      // an angle does not matter there, on either machine
  int steps = 0;                 // of Newton's method
  double miss_p = 0.0;           // m, of the true tip
  double miss_k = 0.0;           // rad, of the true tool axis

  bool is_reached() const { return reach == Reach::reached; }
};

inline constexpr double kPoseTolerance = 1e-12;  // m, rad
inline constexpr int kMaxPoseSteps = 20;

/// Below this share of the tool axis for a turn of 1 rad, an angle does not matter.
inline constexpr double kSingularSlope = 1e-7;

/// @param model   the machine with its errors
/// @param ideal   that of the same chain; its settings choose the solution
/// @param P       true tip (3; m) and unit tool axis (3) in W
/// @param p_ST    tip in the spindle nose (3; m)
/// @param Q_near  joints before (5; m, rad)
/// @pre | |k_W| - 1 | < 1e-9
TrueJoints nonideal_inverse(const VolumetricModel& model, const InverseKinematics& ideal,
                            const ToolPose& P, const Eigen::Vector3d& p_ST, const Joints& Q_near);

/// Newton's method alone, from Q_start (5; m, rad), whatever the travel.
TrueJoints nonideal_inverse_from(const VolumetricModel& model, const ToolPose& P,
                                 const Eigen::Vector3d& p_ST, const Joints& Q_start);

}  // namespace servomill::plant
