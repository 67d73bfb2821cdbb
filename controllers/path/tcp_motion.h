/// Motion of the tool centre point as chords of joint motion.
///
/// A move gives the tip p(t) in the workpiece and the rotary joints, linear in t or linear between
/// the knots of a great circle (tool_centre_point.h). The linear joints follow: with J the
/// directions of the linear axes at these angles,
///
///     Q(t) = (J^-1 (p(t) - p_0(rotary(t))),  rotary(t))                                    (1)
///
/// and chords of Q are halved until the tip of the machine, going linearly in all joints, keeps to
/// p(t). The planner rounds the corners of the chords (smooth_path.h), within tolerances of the
/// joints (chord_tolerances.h).
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "controllers/path/chord_tolerances.h"
#include "controllers/path/feed_reduction.h"
#include "controllers/path/path_limits.h"
#include "controllers/path/tool_centre_point.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/move_list.h"
#include "plant/vocabulary/stored_values.h"

namespace servomill::controllers {

/// One move under tool control.
struct TcpMotion {
  std::size_t move = 0;
  std::size_t first = 0, last = 0;  // chords
  double time = 0.0;                // s, by the programmed feed; 0: as fast as the joints can
};

/// All moves of a program under tool control. Of a long program they are on the disk.
struct TipMotions {
  StoredValues<JointChord> chords;
  StoredValues<TcpMotion> motions;  // in the order of the moves
  // The worst place of each line: by speed wherever it is, by acceleration and jerk where the tool
  // axis turns near a singular direction.
  std::vector<FeedReduction> slowed;

  TipMotions() : TipMotions(PathOptions{}.plans_in_memory) {}
  /// @param most_in_memory  bytes, of chords and of motions
  explicit TipMotions(std::size_t most_in_memory)
      : chords("the chords of motion under TCP control", most_in_memory),
        motions("the moves under TCP control", most_in_memory) {}

  /// For moves one after the other: every so many, memory of chords that were read is given back.
  /// @pre the move is under tool control
  const TcpMotion& of(std::size_t move) const;
  std::span<const JointChord> chords_of(const TcpMotion& motion) const {
    return chords.range(motion.first, motion.last);
  }
};

/// @param moves   of a program; those without tool control are only followed
/// @param tips    p_ST (3; m) by number of tool offset
/// @param start   joints before the first move (5; m, rad)
/// @param limits  of which `slowed` tells
/// @param file    of the program, for faults
/// @throws InputError with every move that the machine cannot do
TipMotions tip_motions(const MoveRange& moves, const ToolCentrePoint& machine,
                       const std::map<int, Eigen::Vector3d>& tips, const Joints& start,
                       const JointLimits& limits, const PathOptions& options,
                       const std::string& file);

}  // namespace servomill::controllers
