/// Speed along a path: as fast as its limits allow, with limited acceleration and jerk.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace servomill::controllers {

/// Limits that hold on one stretch of the path, from the end of the one before to `end`.
struct SegmentLimits {
  double end = 0.0;         // m
  double v = 0.0;           // m/s
  double a = 0.0;           // m/s^2, at every speed up to v
  double j = 0.0;           // m/s^3, at every speed up to v and acceleration up to a
  bool programmed = false;  // v is the programmed speed, not a limit of the machine
};

/// A part of a time law, until the next phase begins: with x = t - `t`, y = s(t) - `s`
///
///     y''' = j + beta y',    that is    y'' = a + j x + beta y                                (1)
///
/// where one of j and beta is zero. beta = 0 is a cubic in time.
struct Phase {
  double t = 0.0, s = 0.0, v = 0.0, a = 0.0, j = 0.0;
  double beta = 0.0;  // 1/s^2

  struct State {
    double s, v, a, j;
  };
  State at(double time) const;
};

struct TimeLaw {
  std::vector<Phase> phases;
  double duration = 0.0;  // s
};

/// Rest to rest over the stretches. Waypoints with zero acceleration stand where a limit of speed
/// would be exceeded otherwise; between two of them the speed rises, stays and falls along S-curves
/// under the least acceleration and jerk of the stretches that they cover.
///
///      v |        ______ limit            1. the highest rise-cruise-fall between two waypoints
///        |   ____/      \                 2. where it exceeds a limit, the lowest such limit
///        |  /    ^       \____               becomes waypoints, and both sides start again at 1
///        | /   waypoint       \           3. a waypoint out of reach is lowered
///        +---------------------- s
///
/// @param stretches  ends increasing, all limits > 0
TimeLaw plan_speed(std::span<const SegmentLimits> stretches);

/// Speeds where a law begins and ends, there without acceleration.
struct EndSpeeds {
  double begin = 0.0, end = 0.0;  // m/s
};

/// The same between two speeds.
/// @return nullopt if the limits do not let one be reached from the other
std::optional<TimeLaw> plan_speed(std::span<const SegmentLimits> stretches,
                                  const EndSpeeds& speeds);

/// A law that passes a place without acceleration. Both parts count time and way from their begin.
struct DividedLaw {
  TimeLaw before, behind;
  double speed = 0.0;  // m/s, there
};

/// From a speed through a place to rest.
/// @param place  m, between the first and the last stretch
/// @return nullopt if the way to rest is too short for the speed at the begin
std::optional<DividedLaw> plan_speed_through(std::span<const SegmentLimits> stretches,
                                             double v_begin, double place);

}  // namespace servomill::controllers
