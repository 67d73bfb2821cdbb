/// Offset of the setpoints along a planned program, as it is learnt from runs of it.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "strategies/strategy.h"

namespace servomill::strategies {

/// Arc length of a planned program at equal intervals of time, its standstill behind the end in it.
struct PathTimes {
  double h = 0.0;         // s, between two instants: a position period
  std::vector<double> s;  // m, not falling
  std::size_t every = 1;  // instants from one row of an offset to the next
  double row_period() const { return h * static_cast<double>(every); }
  std::size_t rows() const { return (s.size() + every - 1) / every; }
};

/// Finds the instant of a planned program at which a run of it is: by arc length and, where that
/// stands, by time. A run of the same plan is at t / h; at another feed it is where the plan is at
/// the same place. Between two instants s is the monotone cubic with slopes of central differences:
/// exact while the jerk is constant, up to those slopes. Source: Fritsch, Carlson, Monotone
/// piecewise cubic interpolation, SIAM J. Numer. Anal. 17 (1980) 238-246.
class PathPlace {
 public:
  /// @param times  must outlive this; at least one instant
  explicit PathPlace(const PathTimes& times) : times_(times) {}

  /// @param t, s  s and m, of the run; not falling
  /// @return number of the instant, with its fraction
  double advance(double t, double s);

 private:
  std::size_t arrival(double s) const;
  std::size_t departure(double s) const;
  double share_of(std::size_t n, double s) const;

  const PathTimes& times_;
  double now_ = 0.0, t_ = 0.0;
  std::optional<double> s_;  // m, of the last call
};

/// Offset of the joints at every so many of those instants.
struct PathOffset {
  std::shared_ptr<const PathTimes> times;
  std::vector<Joints> offset;  // (5; m, rad), row after row

  /// The uniform cubic B-spline whose control points are the rows: between two rows its jerk is
  /// their third difference, acceleration and velocity are continuous. It has
  /// sinc^4(f row_period) of what the rows have.
  /// @param instant  as PathPlace finds it
  Joints at(double instant) const;
  /// At an arc length (m). @pre it rests where the path stands
  Joints at_place(double s) const;
};

/// Smooth step from 0 at x = 0 to 1 at x = 1: first and second derivative are 0 at both ends.
inline double smooth_step(double x) { return x * x * x * (10.0 + x * (6.0 * x - 15.0)); }

/// Lets offsets rest where the path stands: the mean over the standstill there, and smoothly on to
/// it within some hundredths of a second. A program has one offset for each place.
void rest_at_standstills(const PathTimes& times, std::vector<Joints>& offset);

/// The offset as part of a run. It enters behind the nominal-position filter and is fed forward.
/// The machine stands displaced before the program begins.
std::unique_ptr<SetpointPart> path_offset_part(std::shared_ptr<const PathOffset> offset);

}  // namespace servomill::strategies
