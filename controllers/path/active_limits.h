/// Limits that bound a planned motion: where its time goes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>

#include "controllers/path/path_limits.h"
#include "controllers/path/trajectory.h"
#include "plant/vocabulary/move_list.h"

namespace servomill::controllers {

/// Kind of limit that bounds the motion at an instant.
enum class LimitKind : std::uint8_t {
  feed,          // as programmed
  block_time,    // least time of a block (PathOptions::block_time)
  velocity,      // of a joint
  acceleration,  // of a joint
  jerk,          // of a joint
  corner,        // acceleration or jerk of a joint, for the most part that of a corner between
                 // straight blocks, which is rounded within the tolerance
  none,          // each limit is used by less than kInUse
};
inline constexpr std::size_t kLimitKinds = 7;
inline constexpr std::array<std::string_view, kLimitKinds> kLimitNames = {
    "feed", "block time", "velocity", "acceleration", "jerk", "corner tolerance", "none"};

/// Share of a limit from which on it bounds the motion.
inline constexpr double kInUse = 0.9;

/// True for the limits that are those of one joint.
constexpr bool is_of_joint(LimitKind kind) {
  return kind >= LimitKind::velocity && kind <= LimitKind::corner;
}

/// A part of the motion within one move, one piece of the path and one phase of its time law.
struct MotionStretch {
  std::size_t move = 0;  // index
  double time = 0.0;     // s
  LimitKind kind = LimitKind::none;
  int joint = -1;  // whose limit it is; -1: of none
};

/// Hands every stretch of a planned motion to `take`, in order. Dwells are stretches without a
/// limit. The limit of a stretch is the one that is used most in its middle, in time:
///
///     v_path / feed,  |dQ| / v,  |ddQ| / a,  |dddQ| / j    of the path and of each joint (1)
///
/// Law: the times of all stretches add up to the duration.
/// @param moves   that were planned
/// @param limits  and options with which they were planned
void for_each_stretch(const MoveRange& moves, const Trajectory& trajectory,
                      const JointLimits& limits, const PathOptions& options,
                      const std::function<void(const MotionStretch&)>& take);

}  // namespace servomill::controllers
