/// Joint positions that bring a tool straight from one location to the next: the tip along the
/// chord, the tool axis along the great circle, while the machine only moves its joints linearly.
#pragma once

#include <vector>

#include "plant/kinematics/inverse.h"
#include "plant/vocabulary/tool_axis.h"

namespace servomill::plant {

/// The tool between two locations. Tip and tool axis move uniformly in t:
///
///     p(t) = p_0 + t (p_1 - p_0)
///     k(t) = (sin((1 - t) beta) k_0 + sin(t beta) k_1) / sin(beta),  beta = angle(k_0, k_1)
class StraightToolPath {
 public:
  /// @pre unit tool axes, less than kRoundTurn apart
  StraightToolPath(const ToolPose& from, const ToolPose& to);

  ToolPose at(double t) const;
  double angle() const { return angle_; }                           ///< beta (rad)
  double length() const { return (to_.p_WT - from_.p_WT).norm(); }  ///< of the way of the tip (m)

 private:
  ToolPose from_, to_;
  double angle_;
};

/// Tool axes that enclose more have no great circle between them that means anything.
inline constexpr double kRoundTurn = 3.1415;  // rad

/// How far the tool may be from where it should be, at equal t.
struct ToolTolerance {
  double tip = 1e-6;   // m
  double axis = 1e-4;  // rad
};

/// Joints at a place of a path.
struct PathPoint {
  double t = 1.0;
  Joints Q = Joints::Zero();  // m, rad
};

/// Result of `linearise`.
struct LinearisedPath {
  std::vector<PathPoint> points;  // behind the start; the last has t = 1 if it is complete
  bool is_complete = true;
  // if not: where it went no further, and why
  double t = 0.0;
  JointSolution failure;  // reached: the joints that follow would have to jump (a singular
                          // direction, or another solution because of the travel)
};

/// Points between which the joints may move linearly while the tool stays within the tolerance of
/// its path: halves the way until it does. Each point is the solution nearest to the one before.
/// If that leads from a singular direction to the end of a travel, the other branches
/// (branches.h) are followed in turn, and the first that arrives is taken.
/// @param Q_0  joints at t = 0 (5; m, rad)
LinearisedPath linearise(const InverseKinematics& inverse, const Eigen::Vector3d& p_ST,
                         const StraightToolPath& path, const Joints& Q_0,
                         const ToolTolerance& tolerance);

}  // namespace servomill::plant
