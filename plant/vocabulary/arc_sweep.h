/// The circle or helix of an arc as a function of a fraction, in any Cartesian coordinates.
#pragma once

#include <Eigen/Core>

#include "plant/vocabulary/move.h"

namespace servomill {

/// Angles are about the positive normal from the first axis of the plane (G17: X, G18: Z, G19: Y).
struct ArcSweep {
  int a = 0, b = 1, c = 2;                    // first and second axis of the plane, normal
  double centre_a = 0.0, centre_b = 0.0;      // m
  double angle = 0.0;                         // rad, where it begins
  double sweep = 0.0;                         // rad, signed, counter-clockwise positive
  double r_begin = 0.0, r_end = 0.0;          // m; the radius changes linearly if they differ
  double along_begin = 0.0, along_end = 0.0;  // m, on the normal

  ArcSweep() = default;
  /// @param begin, end, centre  X Y Z (m); of the centre the component on the normal is not used
  /// @param turns               as in `Arc`, not 0
  /// Ends seen from the centre in the same direction (within 1e-9 rad) make a full turn.
  ArcSweep(const Eigen::Vector3d& begin, const Eigen::Vector3d& end, const Eigen::Vector3d& centre,
           int normal_axis, int turns);

  /// Point at a fraction of the sweep (0 to 1).
  Eigen::Vector3d point(double fraction) const;
  /// Derivative of the point by the fraction, m.
  Eigen::Vector3d derivative(double fraction) const;
  /// Length of the curve (m), that of the unrolled triangle with the mean radius.
  double length() const;

 private:
  double radius(double fraction) const { return r_begin + (r_end - r_begin) * fraction; }
};

/// @param begin  X Y Z where the move begins, machine coordinates (m)
/// @pre move.kind is arc
ArcSweep arc_sweep(const Move& move, const Eigen::Vector3d& begin);

}  // namespace servomill
