/// Motion of the tool centre point as chords of joint motion.
///
/// A move gives the tip p(t) in the workpiece and the rotary joints, linear in t or linear between
/// the knots of a great circle (tool_centre_point.h). The linear joints follow: with J the
/// directions of the linear axes at these angles,
///
///     Q(t) = (J^-1 (p(t) - p_0(rotary(t))),  rotary(t))                                    (1)
///
/// and chords of Q are halved until the tip of the machine, going linearly in all joints, keeps to
/// p(t). The planner rounds the corners of the chords (smooth_path.h). A joint deviation moves the
/// tip by at most
///
///     |dp| <= |dQ_linear| + a |dQ_rotary|,   a^2 = sum of squares of the arms of the tip    (2)
///
/// so a tolerance T of the tip less what the chords miss is divided among linear and rotary joints,
/// as the direction of the chords changes in them, since corners deviate in that proportion: where
/// the rotary joints are at rest nearly all of it is left to the linear ones. The angle by which
/// the tool axis moves is at most sqrt(2) |dQ_rotary|.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "controllers/path/feed_reduction.h"
#include "controllers/path/path_limits.h"
#include "controllers/path/tool_centre_point.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/move_list.h"

namespace servomill::controllers {

struct JointChord {
  Joints end = Joints::Zero();    // m, rad
  double fraction = 0.0;          // of the move, where the chord ends
  double tolerance_linear = 0.0;  // m, for rounding
  double tolerance_rotary = 0.0;  // rad
  bool is_even = true;            // on a curve without corners (RotaryKnot)
};

/// One move under tool control.
struct TcpMotion {
  std::size_t move = 0;
  std::size_t first = 0, last = 0;  // chords
  double time = 0.0;                // s, by the programmed feed; 0: as fast as the joints can
};

struct TipMotions {
  std::vector<JointChord> chords;
  std::vector<TcpMotion> motions;  // in the order of the moves
  // The worst place of each line: by speed wherever it is, by acceleration and jerk where the tool
  // axis turns near a singular direction.
  std::vector<FeedReduction> slowed;

  const TcpMotion* of(std::size_t move) const;
  std::span<const JointChord> chords_of(const TcpMotion& motion) const {
    return std::span(chords).subspan(motion.first, motion.last - motion.first);
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
