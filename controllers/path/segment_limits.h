/// Limits of the speed along a piece of the path that follow from the joint limits.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "controllers/path/path_limits.h"
#include "controllers/path/smooth_path.h"
#include "controllers/path/time_law.h"

namespace servomill::controllers {

/// Programmed speed; rotary in metres like the path (see PathVertex).
struct FeedLimit {
  double linear = std::numeric_limits<double>::infinity();  // m/s, of X Y Z together
  double rotary = std::numeric_limits<double>::infinity();  // m/s, of the rotary joints together
  double path = std::numeric_limits<double>::infinity();    // m/s, along the path
  bool operator==(const FeedLimit&) const = default;
};

/// Limits of speed v, acceleration a and jerk j along a piece of length h such that on each joint
///
///   |q'| v <= V,   |q''| v^2 + |q'| a <= A,   |q'''| v^3 + 3 |q''| v a + |q'| j <= J      (1)
///
/// @param curve_share  of A and J that the speed may spend on curvature (0 to 1); a and j get what
/// is
///                     left. Long curves gain from a large one, dense corners from a small one.
SegmentLimits segment_limits(const CubicPiece& piece, double h, const JointLimits& limits,
                             const FeedLimit& feed, double curve_share);

/// Largest speed on the piece by feed and joint speeds alone.
double straight_speed(const CubicPiece& piece, double h, const JointLimits& limits,
                      const FeedLimit& feed);

/// Joins neighbours whose speeds differ little under their least limits, so that the speed does not
/// follow every small change of curvature or direction.
std::vector<SegmentLimits> merge_similar(std::span<const SegmentLimits> pieces);

}  // namespace servomill::controllers
