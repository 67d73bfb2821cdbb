/// The corrected path of one move in machine coordinates, from the errors alone.
#pragma once

#include <optional>

#include "controllers/dialects/machine_action.h"
#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/axes.h"
#include "sim/programs/compensate/correction.h"
#include "sim/programs/verification/original.h"

namespace servomill::sim::programs {

/// c(t) = Q(t) + d(Q(t)): Q the programmed position at the share t of the move, d the correction.
/// It knows nothing of how a writer divides moves into blocks.
class CorrectedCurve {
 public:
  /// @param correction  with the tool of the move; must outlive this
  CorrectedCurve(const OriginalAction& action, const Correction& correction);

  /// Keeps these axes where they are.
  void hold(const AxisFlags6& axes, const AxisWords& position);

  AxisWords programmed(double t) const;
  AxisWords at(double t) const;

  /// Length of X Y Z, m, and of the rotary axes, rad; 0 where rounding alone moves them.
  double length() const { return length_; }
  double angle() const { return angle_; }
  bool is_still() const { return length_ == 0.0 && angle_ == 0.0; }
  bool rotates() const { return angle_ > 0.0; }

  /// The share of the move that `end` has reached.
  /// @param from  where the block begins that leads to `end`, at share `t`
  double share(const AxisWords& from, const AxisWords& end, double t,
               const controllers::MachineAction& action) const;
  /// Distance of a position from c(t): across the path where X, Y and Z alone move. m
  double distance(const AxisWords& position, double t) const;
  /// The largest difference of a rotary axis, rad.
  double turn(const AxisWords& position, double t) const;

 private:
  Eigen::Vector3d derivative(double t) const;
  double first_guess(const AxisWords& from, const AxisWords& end, double t,
                     const controllers::MachineAction& action) const;

  const Correction& correction_;
  AxisWords begin_, end_;
  double s_begin_, s_end_;  // m, on the path of the original program
  std::optional<ArcSweep> arc_;
  double length_ = 0.0, angle_ = 0.0;
  AxisFlags6 is_held_{};
  AxisWords held_ = AxisWords::Zero();
};

}  // namespace servomill::sim::programs
