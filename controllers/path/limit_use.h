/// How much of the limits a speed uses anywhere on the way.
#pragma once

#include <span>

#include "controllers/path/path_parts.h"
#include "controllers/path/speed_spline.h"

namespace servomill::controllers {

struct LimitUse {
  double jerk = 0.0, acceleration = 0.0;  // of the limits
  double speed = 0.0;                     // of its square
};

/// Largest uses, bounded between the points by the hull of the polynomials.
/// @param per_jerk  inverse of the limits of jerk (with margin)
/// @param ratio     limits of jerk over those of acceleration
/// @param margin    of both: where the use of jerk is below 1/margin it is not looked at more
///                  closely
LimitUse largest_use(const SmoothPath& path, const SpeedSpline& speed, const PathParts& parts,
                     std::span<const double> v_top, const Joints& per_jerk, const Joints& ratio,
                     double margin);

}  // namespace servomill::controllers
