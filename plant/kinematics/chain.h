/// Ideal kinematics of a machine: the chain of its joints from the workpiece to the tool.
///
///     [w  C'  B'  X  b  Y  Z  t]
///      W ---------> M -------> S -> T        H_WT = Rz(c) Ry(b) Tx(x) Ty(y) Tz(z) H_ST
///        workpiece     tool side
///        side
///
/// Every coordinate counts the motion of the tool as seen from the workpiece, on both sides of the
/// bed. Hence the pose of the tool in the workpiece is the product of the joint motions as they are
/// read, each with a positive sign: a workpiece-side axis with coordinate q moves its table by -q.
/// At zero the frames W, M and S coincide. The tip lies at p_ST in the spindle nose (a tool of
/// length L: (0, 0, -L)); the tool axis k_S = (0, 0, 1) points from the tip to the spindle.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "plant/kinematics/structure.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/tool_pose.h"

namespace servomill::plant {

/// Sign of a rotary coordinate: that of the tool seen from the workpiece, or the opposite one,
/// which is how a table turns as seen from the bed.
enum class Sense : std::uint8_t { tool, table };

struct ChainAxis {
  Axis axis = Axis::X;
  Side side = Side::tool;
  int joint = 0;                                     // its place in Joints
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // m in M, all axes at zero. A rotary axis
                                                     // turns about a line through this point;
                                                     // angular errors of any axis turn about it.
  Sense sense = Sense::tool;                         // rotary axes only
  // Rotary axes only: frame A of the axis in M, in which it turns about X, Y or Z as its letter
  // says and its errors are counted. Not the identity for an inclined axis; set by incline().
  Eigen::Matrix3d R_MA = Eigen::Matrix3d::Identity();
  bool is_inclined = false;
};

/// Lets a rotary axis turn about `direction` (3; not zero, of any length; in M) instead of X, Y or
/// Z. The frame of the axis is M turned the shortest way; for the opposite direction, where many
/// are as short, half a turn about the next of X, Y, Z.
void incline(ChainAxis& axis, const Eigen::Vector3d& direction);

/// Along which, or about which, an axis moves with all axes at zero (unit vector in M), whatever
/// its sense.
Eigen::Vector3d direction_of(const ChainAxis& axis);

struct MachineChain {
  std::vector<ChainAxis> axes;  // reading order
  JointLayout layout;

  /// The axis of that name. @pre the machine has it.
  ChainAxis& at(Axis axis);
  const ChainAxis& at(Axis axis) const;
};

int number_of_linear_axes(const MachineChain& chain);

/// Chain of a structure with all centres at the origin and all senses `tool`.
MachineChain make_chain(const Structure& structure);

/// Pose of the tool when the joints stand at Q.
/// @param Q     joint coordinates (5; m, rad)
/// @param p_ST  tip in the spindle nose (3; m)
ToolPose forward(const MachineChain& chain, const Joints& Q, const Eigen::Vector3d& p_ST);

/// Orientation of the bed seen from the workpiece (3x3): product of the workpiece-side rotations.
Eigen::Matrix3d R_WM(const MachineChain& chain, const Joints& Q);

/// dp_WT/d(X, Y, Z) at Q (3x3, m/m). Columns have length 1; that of an axis that the machine lacks
/// is 0. It does not depend on X, Y, Z.
Eigen::Matrix3d linear_jacobian(const MachineChain& chain, const Joints& Q);

/// Derivatives of the tool pose at Q: dp_WT = J_pQ dQ (m/m, m/rad), dk_W = J_kQ dQ (1/m, 1/rad).
struct PoseJacobian {
  Eigen::Matrix<double, 3, kJoints> J_pQ = Eigen::Matrix<double, 3, kJoints>::Zero();
  Eigen::Matrix<double, 3, kJoints> J_kQ = Eigen::Matrix<double, 3, kJoints>::Zero();
};

/// Derivatives of forward() with respect to all joints; 0 for axes that the machine lacks.
PoseJacobian jacobian(const MachineChain& chain, const Joints& Q, const Eigen::Vector3d& p_ST);

/// Linear joints that bring the tip as near to p_WT as the machine can.
struct LinearJoints {
  Joints Q;               // m, rad; rotary joints as given
  double miss;            // m, between p_WT and the tip
  bool is_unique = true;  // no two linear axes are parallel at these angles
};
LinearJoints linear_joints(const MachineChain& chain, const Eigen::Vector3d& p_WT,
                           const Joints& Q_rotary, const Eigen::Vector3d& p_ST);

/// Linear joints that put the tip at p_WT while the rotary joints stand as in Q_rotary.
/// @return all joints (5; m, rad), or nullopt if the linear axes of the machine, at these angles,
///         cannot reach p_WT within kReachTolerance or not in a unique way
std::optional<Joints> inverse_fixed_rotary(const MachineChain& chain, const Eigen::Vector3d& p_WT,
                                           const Joints& Q_rotary, const Eigen::Vector3d& p_ST);

/// Largest distance of a point from the plane or line of a machine with fewer than three linear
/// axes.
inline constexpr double kReachTolerance = 1e-9;  // m

/// Two linear axes whose directions enclose less than this are taken as parallel.
inline constexpr double kParallel = 1e-9;  // rad

/// Motion of one joint, with the cosine and sine of a rotary one taken once.
struct JointMotion {
  double shift = 0.0;               // m, linear
  double cosine = 1.0, sine = 0.0;  // rotary, tool sense
};
JointMotion motion_at(const ChainAxis& axis, double q);

/// v turned about a coordinate axis.
inline Eigen::Vector3d turned(Axis about, double cosine, double sine, const Eigen::Vector3d& v) {
  const int k = index_of(about) - index_of(Axis::A), i = (k + 1) % 3, j = (k + 2) % 3;
  Eigen::Vector3d u = v;
  u[i] = cosine * v[i] - sine * v[j];
  u[j] = sine * v[i] + cosine * v[j];
  return u;
}

/// R v and R^T v, each sum from left to right as the kernels of the volumetric model add.
inline Eigen::Vector3d times(const Eigen::Matrix3d& R, const Eigen::Vector3d& v) {
  Eigen::Vector3d u;
  for (int i = 0; i < 3; ++i) u[i] = (R(i, 0) * v[0] + R(i, 1) * v[1]) + R(i, 2) * v[2];
  return u;
}
inline Eigen::Vector3d transpose_times(const Eigen::Matrix3d& R, const Eigen::Vector3d& v) {
  Eigen::Vector3d u;
  for (int i = 0; i < 3; ++i) u[i] = (R(0, i) * v[0] + R(1, i) * v[1]) + R(2, i) * v[2];
  return u;
}

/// v turned by a rotary axis.
inline Eigen::Vector3d turned(const ChainAxis& a, const JointMotion& m, const Eigen::Vector3d& v) {
  if (!a.is_inclined) return turned(a.axis, m.cosine, m.sine, v);
  return times(a.R_MA, turned(a.axis, m.cosine, m.sine, transpose_times(a.R_MA, v)));
}

/// Moves a tool pose, given in the frame on the joint's tool side, through one ideal joint.
inline void apply(const ChainAxis& a, const JointMotion& m, ToolPose& P) {
  if (is_linear(a.axis)) {
    P.p_WT[index_of(a.axis)] += m.shift;
    return;
  }
  P.p_WT = turned(a, m, P.p_WT - a.centre) + a.centre;
  P.k_W = turned(a, m, P.k_W);
}

/// The shifts x that bring J x as close as possible to v, the smallest such x; the rank of J.
/// @param J  columns of length 1 or 0 (3x3)
struct LeastSquares {
  Eigen::Vector3d x;
  int rank;
};
LeastSquares least_squares(const Eigen::Matrix3d& J, const Eigen::Vector3d& v);

}  // namespace servomill::plant
