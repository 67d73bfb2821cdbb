#include "plant/geometry/pose_inverse.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "plant/vocabulary/tool_axis.h"

namespace servomill::plant {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix32 = Eigen::Matrix<double, 3, 2>;

constexpr double kMaxTurn = 0.5;   // rad in one step; the derivatives say nothing beyond
constexpr double kShorter = 0.25;  // where a step led away

struct Turn {
  Vector2d dr;
  bool is_singular;
};

// The dr with the least |M dr - s|, the smallest such dr.
Turn smallest_turn(const Matrix32& M, const Vector3d& s) {
  const int i = M.col(0).squaredNorm() >= M.col(1).squaredNorm() ? 0 : 1;
  const Vector3d a = M.col(i), b = M.col(1 - i);
  const double aa = a.squaredNorm();
  Turn out{Vector2d::Zero(), true};
  if (std::sqrt(aa) <= kSingularSlope) return out;
  const double lambda = a.dot(b) / aa;
  const Vector3d across = b - lambda * a;
  out.is_singular = across.norm() <= kSingularSlope;
  if (out.is_singular) {
    const double share = a.dot(s) / (aa * (1.0 + lambda * lambda));
    out.dr[i] = share;
    out.dr[1 - i] = lambda * share;
  } else {
    out.dr[1 - i] = across.dot(s) / across.squaredNorm();
    out.dr[i] = a.dot(s) / aa - lambda * out.dr[1 - i];
  }
  return out;
}

struct Step {
  Joints dQ;
  bool is_singular;
};

Step newton_step(const VolumetricModel& model, const Joints& Q, const Vector3d& p_ST,
                 const Vector3d& s_p, const Vector3d& s_k, double most_turn) {
  const PoseJacobian J = model.jacobian(Q, p_ST);
  const Eigen::Matrix3d J_pl = J.J_pQ.leftCols<3>(), J_kl = J.J_kQ.leftCols<3>();
  const Matrix32 J_pr = J.J_pQ.rightCols<2>(), J_kr = J.J_kQ.rightCols<2>();
  const Vector3d y = least_squares(J_pl, s_p).x;
  Matrix32 X;
  for (int i = 0; i < 2; ++i) X.col(i) = least_squares(J_pl, J_pr.col(i)).x;
  Turn turn = smallest_turn(J_kr - J_kl * X, s_k - J_kl * y);
  const double longest = turn.dr.cwiseAbs().maxCoeff();
  if (longest > most_turn) turn.dr *= most_turn / longest;
  Step step;
  step.dQ << y - X * turn.dr, turn.dr;
  // with less than two rotary axes nothing is free
  const JointLayout& layout = model.chain().layout;
  step.is_singular = turn.is_singular && layout.has(kLinearJoints) && layout.has(kLinearJoints + 1);
  return step;
}

// The pose to ask the ideal machine for, so that the one with errors comes to P from where it is.
ToolPose less_what_errors_do(const ToolPose& P, const ToolPose& asked, const ToolPose& got) {
  return {asked.p_WT + (P.p_WT - got.p_WT), (asked.k_W + (P.k_W - got.k_W)).normalized()};
}

bool is_met(const TrueJoints& found) {
  return found.miss_p <= kPoseTolerance && found.miss_k <= kPoseTolerance;
}

}  // namespace

TrueJoints nonideal_inverse_from(const VolumetricModel& model, const ToolPose& P,
                                 const Vector3d& p_ST, const Joints& Q_start) {
  TrueJoints out;
  out.Q = Q_start;
  const auto look = [&] {
    const ToolPose got = model.forward(out.Q, p_ST);
    out.miss_p = (P.p_WT - got.p_WT).norm();
    out.miss_k = angle_between(P.k_W, got.k_W);
    return got;
  };
  double most_turn = kMaxTurn;
  ToolPose got = look();
  while (!is_met(out) && out.steps < kMaxPoseSteps) {
    const Step step =
        newton_step(model, out.Q, p_ST, P.p_WT - got.p_WT, P.k_W - got.k_W, most_turn);
    if (!step.dQ.allFinite()) break;
    out.is_singular = step.is_singular;
    out.Q += step.dQ;
    ++out.steps;
    const double miss_k = out.miss_k;
    got = look();
    if (out.miss_k > miss_k) {
      most_turn = kShorter * std::min(most_turn, step.dQ.tail<2>().cwiseAbs().maxCoeff());
    }
    constexpr double kStanding = 1e-15;  // m, rad
    if (step.dQ.cwiseAbs().maxCoeff() <= kStanding) break;
  }
  // the tip first
  if (!(out.miss_p <= kPoseTolerance)) {
    out.Q = model.inverse(P.p_WT, out.Q, p_ST).value_or(out.Q);
    look();
  }
  if (!(out.miss_k <= kPoseTolerance)) out.reach = Reach::orientation;
  if (!(out.miss_p <= kPoseTolerance)) out.reach = Reach::position;
  return out;
}

TrueJoints nonideal_inverse(const VolumetricModel& model, const InverseKinematics& ideal,
                            const ToolPose& P, const Vector3d& p_ST, const Joints& Q_near) {
  const JointSolution asked = ideal.nearest(P, p_ST, Q_near);
  const ToolPose got = model.forward(asked.Q, p_ST);
  const ToolPose corrected = less_what_errors_do(P, forward(model.chain(), asked.Q, p_ST), got);
  const JointSolutions starts = ideal.solve(corrected, p_ST, asked.Q);
  TrueJoints out;
  for (int i = 0; i < starts.count; ++i) {
    const Joints& Q_start = starts.all[static_cast<std::size_t>(i)].Q;
    TrueJoints found = nonideal_inverse_from(model, P, p_ST, Q_start);
    if (found.is_reached() && !ideal.is_within_travel(found.Q)) found.reach = Reach::travel;
    // that a pose is met beyond the travel says more than that it is not
    const bool is_better = found.is_reached() || (found.reach == Reach::travel && !is_met(out));
    if (i == 0 || is_better) out = found;
    if (out.is_reached()) break;
  }
  out.is_singular = out.is_singular || asked.is_singular;
  if (!out.is_reached() && asked.reach == Reach::parallel_axes) out.reach = asked.reach;
  return out;
}

}  // namespace servomill::plant
