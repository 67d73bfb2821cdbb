/// Programmed speeds along a motion from rest to rest, and its fastest time law.
#pragma once

#include <cstdint>
#include <vector>

#include "controllers/path/path_limits.h"
#include "controllers/path/segment_limits.h"
#include "controllers/path/smooth_path.h"
#include "controllers/path/time_law.h"
#include "controllers/path/trajectory.h"

namespace servomill::controllers {

/// Moves along the path from rest to rest, and their speeds.
struct ChainSpeeds {
  struct Span : Trajectory::Chain::Span {
    std::uint32_t feed = 0;  // index into feeds
  };
  std::vector<Span> spans;
  std::vector<FeedLimit> feeds;
  std::vector<double> times;  // s, least of each chord under TCP control by the feed of the TCP

  /// Index of a feed, which mostly is that of the move before.
  std::uint32_t index_of(const FeedLimit& feed);
  /// Least time (s) of a chord; 0: none is given.
  double time_of(const Span& span) const;
  void clear();
};

/// The fastest law along a path that keeps speeds and limits.
/// @param limits  of the scaled joints
TimeLaw fastest_law(const SmoothPath& path, const ChainSpeeds& speeds, const JointLimits& limits,
                    const PathOptions& options);

/// Limits of a law along a long path, with the share for curvature that long paths take.
std::vector<SegmentLimits> limits_along(const SmoothPath& path, const ChainSpeeds& speeds,
                                        const JointLimits& limits, const PathOptions& options);

/// The quicker law that is found from one within those limits.
TimeLaw refined_law(TimeLaw law, const SmoothPath& path, const ChainSpeeds& speeds,
                    const JointLimits& limits, const PathOptions& options,
                    const std::vector<SegmentLimits>& stretches, const EndSpeeds& ends);

}  // namespace servomill::controllers
