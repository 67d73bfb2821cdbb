#include "plant/kinematics/branches.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servomill::plant {
namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;

// The axis nearest to the workpiece: its angle is free where the tool axis is parallel to it.
std::optional<int> free_joint(const MachineChain& chain) {
  const auto rotary = std::find_if(chain.axes.begin(), chain.axes.end(),
                                   [](const ChainAxis& a) { return !is_linear(a.axis); });
  if (rotary == chain.axes.end()) return std::nullopt;
  return rotary->joint;
}

double rotary_way(const Joints& from, const Joints& to) {
  return (to - from).tail<kJoints - kLinearJoints>().cwiseAbs().maxCoeff();
}

}  // namespace

std::vector<Joints> departures(const InverseKinematics& inverse, const ToolPose& P,
                               const Eigen::Vector3d& p_ST, const Joints& Q_near) {
  const JointSolutions solutions = inverse.solve(P, p_ST, Q_near);
  const auto free = free_joint(inverse.chain());
  std::vector<Joints> out;
  for (int i = 0; i < solutions.count; ++i) {
    const JointSolution& solution = solutions.all[static_cast<std::size_t>(i)];
    if (!solution.is_reached()) continue;
    out.push_back(solution.Q);
    for (const double turn : {-kFullTurn, kFullTurn}) {
      if (!free) break;
      Joints Q = solution.Q;
      Q[*free] += turn;
      if (inverse.is_within_travel(Q)) out.push_back(Q);
    }
  }
  std::stable_sort(out.begin(), out.end(), [&](const Joints& a, const Joints& b) {
    return rotary_way(Q_near, a) < rotary_way(Q_near, b);
  });
  return out;
}

std::optional<int> joint_at_its_end(const InverseKinematics& inverse, const ToolPose& P,
                                    const Eigen::Vector3d& p_ST, const Joints& Q) {
  const Joints on = InverseKinematics(inverse.chain()).nearest(P, p_ST, Q).Q;
  const InverseSettings& travel = inverse.settings();
  int joint = 0;
  const double beyond = (travel.lower - on).cwiseMax(on - travel.upper).maxCoeff(&joint);
  if (!(beyond > 0.0)) return std::nullopt;
  return joint;
}

}  // namespace servomill::plant
