/// Stretches on which the joints cannot follow the programmed feed.
#pragma once

#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include "controllers/path/path_limits.h"
#include "plant/vocabulary/move_list.h"

namespace servomill::controllers {

/// A place where the programmed feed needs more of a joint than its speed, acceleration or jerk.
struct FeedReduction {
  int line = 0;
  int joint = 0;
  double needed = 0.0,
         allowed = 0.0;  // m/s^order or rad/s^order: at the programmed feed, the limit
  double singular_angle = 0.5 * std::numbers::pi;  // rad, of the tool axis from a singular
                                                   // direction there; far off if that is no reason
  int order = 1;                                   // 1 speed, 2 acceleration, 3 jerk
  std::size_t others = 0;                          // blocks that are slowed down, too

  /// Share of the programmed feed that remains: the derivative of that order goes with its power.
  /// Holds for a steady feed; where it has to fall for a moment only, it falls somewhat farther.
  double share() const;
};

/// Angle to a singular direction within which a joint turns fast because of it: more than five
/// times as fast as the tool axis.
inline constexpr double kNearSingular = 0.2;  // rad

/// "the programmed feed needs C at ..."
std::string to_string(const FeedReduction& slowed, const JointLayout& layout);

/// Way over feed of all blocks with a feed, s: no plan is faster. Blocks under tool control, whose
/// ways are not those of the axes, are not counted.
/// @param start  words of the axes before the first move (m, rad)
double least_time(const MoveRange& moves, const AxisWords& start, const PathOptions& options);

/// The block in inverse time (G93), without tool control, that asks most of a joint beyond its
/// speed, and how many others do; of arcs only their mean speeds are seen. Feeds in units per
/// minute are what an NC may fall short of without a word.
/// @param moves  of a program
/// @param start  joints before the first move (5; m, rad)
std::optional<FeedReduction> slowed_inverse_time(const MoveRange& moves, const JointLayout& layout,
                                                 const Joints& start, const JointLimits& limits,
                                                 const PathOptions& options);

}  // namespace servomill::controllers
