/// The circle or helix of an arc move in machine coordinates, as a function of a fraction.
#pragma once

#include <Eigen/Core>

#include "plant/vocabulary/move.h"

namespace servomill::controllers {

/// Angles are about the positive normal from the first axis of the plane (G17: X, G18: Z, G19: Y).
struct ArcSweep {
  int a = 0, b = 1, c = 2;                // first and second axis of the plane, normal
  double centre_a = 0.0, centre_b = 0.0;  // m
  double angle = 0.0;                     // rad, where it begins
  double sweep = 0.0;                     // rad, signed, counter-clockwise positive
  double r_begin = 0.0, r_end = 0.0;      // m; the radius changes linearly if they differ
  Eigen::Vector3d begin, end;             // m

  /// Point at a fraction of the sweep (0 to 1); exact at both ends.
  Eigen::Vector3d point(double fraction) const;
  /// Derivative of the point by the fraction, m.
  Eigen::Vector3d derivative(double fraction) const;
};

/// @param begin  X Y Z where the move begins, machine coordinates (m)
/// @pre move.kind is arc and the radius is not zero
/// Equal begin and end angles (within 1e-8 rad) mean a full turn.
ArcSweep arc_sweep(const Move& move, const Eigen::Vector3d& begin);

}  // namespace servomill::controllers
