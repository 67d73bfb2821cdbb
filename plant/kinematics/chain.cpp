#include "plant/kinematics/chain.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace servomill::plant {
namespace {

void turn_columns(const ChainAxis& a, double q, Eigen::Matrix3d& R) {
  const JointMotion m = motion_at(a, q);
  for (int i = 0; i < 3; ++i) R.col(i) = turned(a.axis, m.cosine, m.sine, R.col(i));
}

}  // namespace

ChainAxis& MachineChain::at(Axis axis) {
  const auto found =
      std::find_if(axes.begin(), axes.end(), [axis](const ChainAxis& a) { return a.axis == axis; });
  assert(found != axes.end());
  return *found;
}

const ChainAxis& MachineChain::at(Axis axis) const {
  return const_cast<MachineChain*>(this)->at(axis);
}

int number_of_linear_axes(const MachineChain& chain) {
  return static_cast<int>(std::count_if(chain.axes.begin(), chain.axes.end(),
                                        [](const ChainAxis& a) { return is_linear(a.axis); }));
}

MachineChain make_chain(const Structure& structure) {
  MachineChain chain{{}, structure.layout()};
  for (const StructureAxis& a : structure.axes) {
    ChainAxis axis;
    axis.axis = a.axis;
    axis.side = a.side;
    axis.joint = *chain.layout.joint_of(a.axis);
    chain.axes.push_back(axis);
  }
  return chain;
}

JointMotion motion_at(const ChainAxis& axis, double q) {
  if (is_linear(axis.axis)) return {.shift = q};
  if (q == 0.0) return {};
  if (axis.sense == Sense::table) q = -q;
  return {.cosine = std::cos(q), .sine = std::sin(q)};
}

ToolPose forward(const MachineChain& chain, const Joints& Q, const Eigen::Vector3d& p_ST) {
  ToolPose P{p_ST, Eigen::Vector3d::UnitZ()};
  for (auto a = chain.axes.rbegin(); a != chain.axes.rend(); ++a) {
    apply(*a, motion_at(*a, Q[a->joint]), P);
  }
  return P;
}

Eigen::Matrix3d R_WM(const MachineChain& chain, const Joints& Q) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  for (auto a = chain.axes.rbegin(); a != chain.axes.rend(); ++a) {
    if (a->side == Side::workpiece && !is_linear(a->axis)) turn_columns(*a, Q[a->joint], R);
  }
  return R;
}

Eigen::Matrix3d linear_jacobian(const MachineChain& chain, const Joints& Q) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
  for (auto a = chain.axes.rbegin(); a != chain.axes.rend(); ++a) {
    if (is_linear(a->axis)) {
      J(index_of(a->axis), a->joint) = 1.0;
    } else {
      turn_columns(*a, Q[a->joint], J);
    }
  }
  return J;
}

LeastSquares least_squares(const Eigen::Matrix3d& J, const Eigen::Vector3d& v) {
  // three axes far from parallel, as most machines have them: no need to look for the rank
  constexpr double kFarFromParallel = 0.5;  // determinant of directions of about unit length
  if (std::abs(J.determinant()) > kFarFromParallel) return {J.inverse() * v, 3};
  Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix3d> QR;
  QR.setThreshold(kParallel);
  QR.compute(J);
  return {QR.solve(v), static_cast<int>(QR.rank())};
}

std::optional<Joints> inverse_fixed_rotary(const MachineChain& chain, const Eigen::Vector3d& p_WT,
                                           const Joints& Q_rotary, const Eigen::Vector3d& p_ST) {
  Joints Q = Q_rotary;
  Q.head<kLinearJoints>().setZero();
  // The tip is an affine function of the linear joints; the second round removes rounding.
  const Eigen::Matrix3d J = linear_jacobian(chain, Q);
  const Eigen::Vector3d way = p_WT - forward(chain, Q, p_ST).p_WT;
  Eigen::Vector3d q = Eigen::Vector3d::Zero();
  for (int round = 0; round < 2; ++round) {
    const LeastSquares step = least_squares(J, way - J * q);
    if (step.rank < number_of_linear_axes(chain)) return std::nullopt;
    q += step.x;
  }
  if (!((way - J * q).norm() <= kReachTolerance)) return std::nullopt;
  Q.head<kLinearJoints>() = q;
  return Q;
}

}  // namespace servomill::plant
