#include "plant/kinematics/linear_joints.h"

namespace servomill::plant {

TipOfLinearJoints tip_of_linear_joints(const MachineChain& chain, const Joints& Q_rotary,
                                       const Eigen::Vector3d& p_ST) {
  TipOfLinearJoints out{p_ST, Eigen::Matrix3d::Zero()};
  for (auto a = chain.axes.rbegin(); a != chain.axes.rend(); ++a) {
    if (is_linear(a->axis)) {
      out.J(index_of(a->axis), a->joint) = 1.0;
      continue;
    }
    const JointMotion m = motion_at(*a, Q_rotary[a->joint]);
    out.tip = turned(*a, m, out.tip - a->centre) + a->centre;
    for (int i = 0; i < kLinearJoints; ++i) out.J.col(i) = turned(*a, m, out.J.col(i));
  }
  out.is_plain = out.J.isIdentity(0.0);
  return out;
}

LinearJoints linear_joints(const MachineChain& chain, const TipOfLinearJoints& tip,
                           const Eigen::Vector3d& p_WT, const Joints& Q_rotary) {
  LinearJoints out{Q_rotary, 0.0};
  const Eigen::Vector3d way = p_WT - tip.tip;
  if (tip.is_plain && way.allFinite()) {                          // as solved below
    out.Q.head<kLinearJoints>() = way + Eigen::Vector3d::Zero();  // no negative zeros
    return out;
  }
  // The second round removes rounding.
  Eigen::Vector3d q = Eigen::Vector3d::Zero();
  for (int round = 0; round < 2; ++round) {
    const LeastSquares step = least_squares(tip.J, way - tip.J * q);
    out.is_unique = step.rank == number_of_linear_axes(chain);
    q += step.x;
  }
  out.miss = (way - tip.J * q).norm();
  out.Q.head<kLinearJoints>() = q;
  return out;
}

std::optional<Joints> inverse_fixed_rotary(const MachineChain& chain, const TipOfLinearJoints& tip,
                                           const Eigen::Vector3d& p_WT, const Joints& Q_rotary) {
  const LinearJoints linear = linear_joints(chain, tip, p_WT, Q_rotary);
  if (!linear.is_unique || !(linear.miss <= kReachTolerance)) return std::nullopt;
  return linear.Q;
}

}  // namespace servomill::plant
