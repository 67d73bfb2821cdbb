#include "plant/kinematics/chain.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "plant/kinematics/linear_joints.h"
#include "plant/vocabulary/sine_and_cosine.h"

namespace servomill::plant {
namespace {

void turn_columns(const ChainAxis& a, double q, Eigen::Matrix3d& R) {
  const JointMotion m = motion_at(a, q);
  for (int i = 0; i < 3; ++i) R.col(i) = turned(a, m, R.col(i));
}

// Turns columns i and j of A, and those of V likewise, to a right angle; false if they stand at
// one.
bool turn_apart(int i, int j, Eigen::Matrix3d& A, Eigen::Matrix3d& V) {
  const double a = A.col(i).squaredNorm(), b = A.col(j).squaredNorm(), c = A.col(i).dot(A.col(j));
  if (std::abs(c) <= std::numeric_limits<double>::epsilon() * std::sqrt(a * b)) return false;
  const double zeta = (b - a) / (2.0 * c);
  const double tangent = std::copysign(1.0, zeta) / (std::abs(zeta) + std::hypot(1.0, zeta));
  const double cosine = 1.0 / std::hypot(1.0, tangent), sine = cosine * tangent;
  for (Eigen::Matrix3d* M : {&A, &V}) {
    const Eigen::Vector3d old = M->col(i);
    M->col(i) = cosine * old - sine * M->col(j);
    M->col(j) = sine * old + cosine * M->col(j);
  }
  return true;
}

// Least squares of any rank, by the singular values of J: one-sided Jacobi rotations make the
// columns of A = J V orthogonal, whose lengths they are. Three columns need some five rounds. (The
// rank-revealing decomposition of Eigen takes g++ as long as all other sources of this folder.)
// Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., 8.6.3.
LeastSquares singular_least_squares(const Eigen::Matrix3d& J, const Eigen::Vector3d& v) {
  // Bounds rounds in which rounding alone would go on rotating.
  constexpr int kMaxRounds = 30;
  Eigen::Matrix3d A = J, V = Eigen::Matrix3d::Identity();
  for (int round = 0; round < kMaxRounds; ++round) {
    bool turned = turn_apart(0, 1, A, V);
    turned |= turn_apart(0, 2, A, V);
    turned |= turn_apart(1, 2, A, V);
    if (!turned) break;
  }
  // of two columns of length 1 at a small angle, the values have half its ratio
  const double least = 0.5 * kParallel * A.colwise().norm().maxCoeff();
  LeastSquares out{Eigen::Vector3d::Zero(), 0};
  for (int i = 0; i < 3; ++i) {
    const double length = A.col(i).norm();
    if (!(length > least)) continue;
    out.x += V.col(i) * (A.col(i).dot(v) / (length * length));
    ++out.rank;
  }
  return out;
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

void incline(ChainAxis& axis, const Eigen::Vector3d& direction) {
  assert(!is_linear(axis.axis) && direction.squaredNorm() > 0.0);
  const int own = index_of(axis.axis) % 3;
  const Eigen::Vector3d from = Eigen::Vector3d::Unit(own), to = direction.normalized();
  Eigen::Vector3d across = to;
  across[own] = 0.0;
  axis.is_inclined = to != from;
  axis.R_MA.setIdentity();
  if (!axis.is_inclined) return;
  // half a turn about `from`, then half a turn about the middle between it and `to`
  const double half = 0.5 * std::atan2(across.norm(), to[own]);
  if (across.isZero(0.0)) across = Eigen::Vector3d::Unit((own + 2) % 3);
  const Eigen::Vector3d middle = std::cos(half) * from + std::sin(half) * across.normalized();
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  axis.R_MA = (2.0 * middle * middle.transpose() - one) * (2.0 * from * from.transpose() - one);
}

Eigen::Vector3d direction_of(const ChainAxis& axis) {
  return axis.R_MA.col(index_of(axis.axis) % 3);
}

JointMotion motion_at(const ChainAxis& axis, double q) {
  if (is_linear(axis.axis)) return {.shift = q};
  if (q == 0.0) return {};
  if (axis.sense == Sense::table) q = -q;
  const auto [sine, cosine] = is_large(q) ? large_sine_and_cosine(q) : sine_and_cosine(q);
  return {.cosine = cosine, .sine = sine};
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
  return singular_least_squares(J, v);
}

PoseJacobian jacobian(const MachineChain& chain, const Joints& Q, const Eigen::Vector3d& p_ST) {
  PoseJacobian J;
  ToolPose P{p_ST, Eigen::Vector3d::UnitZ()};
  for (auto a = chain.axes.rbegin(); a != chain.axes.rend(); ++a) {
    const JointMotion m = motion_at(*a, Q[a->joint]);
    apply(*a, m, P);
    if (is_linear(a->axis)) {
      J.J_pQ(index_of(a->axis), a->joint) = 1.0;
      continue;
    }
    for (int j = 0; j < kJoints; ++j) {
      J.J_pQ.col(j) = turned(*a, m, J.J_pQ.col(j));
      J.J_kQ.col(j) = turned(*a, m, J.J_kQ.col(j));
    }
    const Eigen::Vector3d w = (a->sense == Sense::table ? -1.0 : 1.0) * direction_of(*a);
    J.J_pQ.col(a->joint) = w.cross(P.p_WT - a->centre);
    J.J_kQ.col(a->joint) = w.cross(P.k_W);
  }
  return J;
}

LinearJoints linear_joints(const MachineChain& chain, const Eigen::Vector3d& p_WT,
                           const Joints& Q_rotary, const Eigen::Vector3d& p_ST) {
  return linear_joints(chain, tip_of_linear_joints(chain, Q_rotary, p_ST), p_WT, Q_rotary);
}

std::optional<Joints> inverse_fixed_rotary(const MachineChain& chain, const Eigen::Vector3d& p_WT,
                                           const Joints& Q_rotary, const Eigen::Vector3d& p_ST) {
  return inverse_fixed_rotary(chain, tip_of_linear_joints(chain, Q_rotary, p_ST), p_WT, Q_rotary);
}

}  // namespace servomill::plant
