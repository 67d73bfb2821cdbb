/// Linear joints for many tips while the rotary joints stand.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "plant/kinematics/chain.h"

namespace servomill::plant {

/// The tip while the rotary joints stand, an affine function of the linear ones:
///
///     p_WT = tip + J (X, Y, Z)
struct TipOfLinearJoints {
  Eigen::Vector3d tip;    // m, with the linear joints at 0
  Eigen::Matrix3d J;      // m/m; the column of an axis that the machine lacks is 0
  bool is_plain = false;  // J is the identity: no axis is turned or missing
};

/// @param Q_rotary  only its rotary joints count (5; m, rad)
/// @param p_ST      tip in the spindle nose (3; m)
TipOfLinearJoints tip_of_linear_joints(const MachineChain& chain, const Joints& Q_rotary,
                                       const Eigen::Vector3d& p_ST);

/// As the functions of the same names in chain.h, to the bit.
/// @param tip  of the chain and Q_rotary
LinearJoints linear_joints(const MachineChain& chain, const TipOfLinearJoints& tip,
                           const Eigen::Vector3d& p_WT, const Joints& Q_rotary);
std::optional<Joints> inverse_fixed_rotary(const MachineChain& chain, const TipOfLinearJoints& tip,
                                           const Eigen::Vector3d& p_WT, const Joints& Q_rotary);

}  // namespace servomill::plant
