/// One move as a part of the scaled path, and the corners between two of them.
#pragma once

#include <limits>
#include <span>

#include "controllers/path/path_limits.h"
#include "controllers/path/segment_limits.h"
#include "controllers/path/tcp_motion.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"

namespace servomill::controllers {

/// A move on the scaled path: joints in metres, rotary ones times the rotary radius.
struct Leg {
  bool rapid = false, rotary_only = false;
  bool stop_after = false, exact_corners = false;
  Joints tangent_begin, tangent_end;  // unit, scaled
  double length = 0.0;                // m, scaled
  double tolerance = 0.0;             // m
  // m, of rotary joints, scaled, where they round corners as well
  double rotary_tolerance = std::numeric_limits<double>::infinity();
  double feed = 0.0;  // m/s along the scaled path
  bool is_synchronised = false;
  double acceleration_share = 1.0;  // of the axes' acceleration, that the spindle can follow
};

/// The leg of a move, but for its length and its tangents.
Leg leg_of(const Move& move);

/// Limits that the spindle of a leg can follow.
JointLimits limits_of(const Leg& leg, JointLimits limits);

/// Tolerances of a move under TCP control, as its first and its last chord have them; none: 0.
void set_tolerances(Leg& leg, std::span<const JointChord> chords, double rotary_radius);

/// Metres of the scaled path per unit of each joint.
Joints scale_of(const PathOptions& options);

/// Speeds and tolerances of legs, and the corners at which the motion stops.
class LegRules {
 public:
  /// @param limits  of the scaled joints
  LegRules(const JointLimits& limits, const PathOptions& options)
      : limits_(limits), options_(options) {}

  /// Distance (m) that the path may keep from the programmed one.
  double tolerance_of(const Move& move) const;

  FeedLimit feed_limit(const Move& move, const Leg& leg) const;

  /// Programmed speed (m/s) along the scaled path, where it goes straight.
  double speed_along(const Leg& leg, const Move& move) const;

  /// Share of the acceleration of the axes that a spindle which turns with them can follow.
  double acceleration_share(const Leg& leg, const Move& move) const;

  /// Tells if the motion stops between two legs: from rapid to feed, from rotary-only to other
  /// moves, at reversals, at the corners of G61, around what the spindle turns with, and where a
  /// stop is faster than a rounding.
  bool must_stop(const Leg& from, const Leg& to) const;

 private:
  bool stopping_is_faster(const Leg& from, const Leg& to, const Joints& turn) const;

  JointLimits limits_;
  PathOptions options_;
};

}  // namespace servomill::controllers
