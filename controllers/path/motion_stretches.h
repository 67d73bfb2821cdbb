/// A long motion, planned in stretches.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "controllers/path/chain_speeds.h"
#include "controllers/path/collected_motion.h"
#include "controllers/path/path_limits.h"
#include "controllers/path/time_law.h"
#include "controllers/path/trajectory.h"

namespace servomill::controllers {

/// Each stretch begins and ends in the middle of a chord, straight and without acceleration, at a
/// speed from which the stretch behind can come to rest. So none depends on more than its
/// neighbours, and memory and time of planning do not grow with the motion.
class MotionStretches {
 public:
  using Chain = Trajectory::Chain;

  /// @param limits  of the scaled joints
  MotionStretches(const JointLimits& limits, const PathOptions& options)
      : limits_(limits), options_(options) {}

  bool empty() const { return !waiting_; }

  /// Takes the next stretch of the motion.
  /// @return the stretch before, whose speed at the end is known now; none if this is the first.
  ///         Its time and its ends are left open
  std::optional<Chain> add(CollectedMotion motion);
  /// The last stretch, which ends at rest.
  Chain finish();

 private:
  struct Stretch {
    std::shared_ptr<Chain::Plan> plan;
    ChainSpeeds speeds;
    std::vector<Chain::Share> shares;
    std::vector<SegmentLimits> limits;
    double v_begin = 0.0;  // m/s
    TimeLaw to_rest;       // of the look-ahead, from v_begin
  };

  Chain take(TimeLaw law, double v_end);

  JointLimits limits_;
  PathOptions options_;
  std::optional<Stretch> waiting_;
};

}  // namespace servomill::controllers
