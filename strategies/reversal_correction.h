/// Share of a displacement of X, Y and Z that follows from the directions of travel: hysteresis of
/// identified errors (plant/geometry/reversal_memory.h).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/geometry/reversal_memory.h"
#include "strategies/strategy.h"

namespace servomill::strategies {

/// Follows a program from its start. The axes of a machine with hysteresis turn round where they
/// are, so that a compensated program is followed at its displaced positions:
///
///     x = Q + d_mean(Q) + d,    J(Q) d = -(e(Q; directions at x) - e(Q))
///
/// An imposed error follows the programmed positions: x = Q, and d has the other sign.
class ReversalCorrection {
 public:
  /// @param identified  must outlive this
  /// @param Q           where the axes start, after no travel
  ReversalCorrection(const IdentifiedMachine& identified, Action action, const Joints& Q);

  bool is_needed() const { return !memory_.empty(); }

  /// Displacement (3; m) to add to d_mean. Lost motion that the axis takes up in less travel than
  /// its width makes a step.
  /// @param Q       position without displacement; since `travel` no joint has reversed
  /// @param d_mean  displacement by the mean of both directions (5; m, rad)
  Eigen::Vector3d displacement(const Joints& Q, const Joints& d_mean) const;

  /// The axes have gone to Q.
  /// @param d             displacement as commanded there (5; m, rad)
  /// @param displacement  what displacement() gave there
  void travel(const Joints& Q, const Joints& d, const Eigen::Vector3d& displacement);

 private:
  const IdentifiedMachine& identified_;
  Action action_;
  plant::ReversalMemory memory_;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
};

}  // namespace servomill::strategies
