/// The limits of the joints as forms in the square of the speed, on a piece of a path.
#pragma once

#include <Eigen/Core>

#include "controllers/path/smooth_path.h"

namespace servomill::controllers {

/// (1) of time_optimal_law.h at a point, divided by the limit of jerk: jerk = (j0 b + j1 b' + j2
/// b'') sqrt(b). The acceleration follows from j1 and j2.
struct LimitForm {
  Joints j0, j1, j2;

  /// @param x         m, from where the piece begins
  /// @param per_jerk  inverse of the limits
  static LimitForm on(const CubicPiece& piece, double x, const Joints& per_jerk) {
    const Joints q1 = piece.c1 + x * (piece.c2 + 0.5 * x * piece.c3), q2 = piece.c2 + x * piece.c3;
    return {piece.c3.cwiseProduct(per_jerk), 1.5 * q2.cwiseProduct(per_jerk),
            0.5 * q1.cwiseProduct(per_jerk)};
  }
  /// x metres on.
  LimitForm shifted(double x) const {
    return {j0, j1 + (1.5 * x) * j0, j2 + x * (j1 / 3.0 + (0.25 * x) * j0)};
  }
  Joints jerk(const Eigen::Vector3d& x) const { return j0 * x[0] + j1 * x[1] + j2 * x[2]; }
  /// @param ratio  limits of jerk over those of acceleration
  Joints acceleration(const Eigen::Vector3d& x, const Joints& ratio) const {
    return ratio.cwiseProduct((2.0 / 3.0 * x[0]) * j1 + x[1] * j2);
  }
};

}  // namespace servomill::controllers
