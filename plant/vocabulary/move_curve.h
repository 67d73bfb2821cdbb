/// A canonical move as a curve in the coordinates of `Move::end_machine`: straight in all axes, an
/// arc or helix, or a spline.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"

namespace servomill {

/// Position over t in [0, 1]; t is proportional to the arc length (for arcs whose end radius
/// differs from the first one, to the angle).
class MoveCurve {
 public:
  MoveCurve() = default;
  /// @param from  machine coordinates where the move begins (6; m, rad)
  /// @pre is_motion(move.kind)
  MoveCurve(const AxisWords& from, const Move& move);
  /// A straight one.
  MoveCurve(const AxisWords& from, const AxisWords& to);

  AxisWords at(double t) const;

  /// Length of the path of X, Y, Z (m).
  double length() const { return length_; }
  /// Angle of an arc (rad, positive); 0 of a straight move.
  double sweep() const;

  /// t in [0, 1] of the point of the curve of X, Y, Z that is closest to p (3; m). For helices the
  /// axial distance does not count in the choice of the angle.
  double closest(const Eigen::Vector3d& p) const;

 private:
  AxisWords from_ = AxisWords::Zero(), to_ = AxisWords::Zero();
  std::optional<ArcSweep> arc_;  // in the plane, if there is one
  std::shared_ptr<const WorkPlane> plane_;
  std::shared_ptr<const Spline> spline_;
  double length_ = 0.0;
};

}  // namespace servomill
