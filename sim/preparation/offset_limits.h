/// Limits of the axes under a path with an offset.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "controllers/path/path_limits.h"
#include "controllers/path/trajectory.h"
#include "strategies/path_offset.h"

namespace servomill::sim::preparation {

/// Velocity, acceleration and jerk of the joints (5 each; m, rad) at an instant.
using PathDerivatives = std::array<Joints, 3>;

/// Their smallest and largest values from one row to the next: a jerk may change in between.
struct PathRange {
  PathDerivatives low, high;
};

/// Ranges of a path from its derivatives, instant after instant.
class PathRanges {
 public:
  /// @param every  instants from row to row
  explicit PathRanges(std::size_t every) : every_(every) {}
  void add(const PathDerivatives& now);
  const std::vector<PathRange>& rows() const { return rows_; }

 private:
  std::size_t every_, instants_ = 0;
  std::vector<PathRange> rows_;
};

/// Ranges of the derivatives of a path, row after row.
std::vector<PathRange> derivatives_of(const controllers::Trajectory& path,
                                      const strategies::PathTimes& times);

/// A planned path, and what it leaves of the limits to an offset. Derivatives of the path are its
/// own, at every position period; those of an offset are differences of its rows: they are the
/// jerk from a row to the next, and control points of acceleration and velocity
/// (strategies/path_offset.h).
class OffsetLimits {
 public:
  /// @param path  as the axes follow it, row after row
  /// @param row_period  s
  /// @param limits  of the axes; 0 of a joint that the machine lacks
  OffsetLimits(std::vector<PathRange> path, double row_period,
               const controllers::JointLimits& limits);

  /// Largest velocity, acceleration and jerk of path and offset together.
  /// @param u  row after row (5; m, rad)
  controllers::JointLimits demands(const std::vector<Joints>& u) const;

  /// Lets an offset begin and end at rest: the machine is at standstill before and after it.
  /// @param within  s
  void rest_at_ends(std::vector<Joints>& u, double within) const;

  /// An offset near this one (sum of squares) with which the path keeps the limits: the nearest of
  /// them, up to some per cent of the change where the excess is small. Only rows within a
  /// quarter of a second of those that exceed them change. With
  ///
  ///     minimise |x - u|^2 / 2   with   l <= D x <= h,   D: first to third differences
  ///
  /// by the alternating direction method of multipliers: D x is clipped and x follows, in turn.
  /// Source: Boyd, Parikh, Chu, Peleato, Eckstein, Distributed optimization and statistical
  /// learning via the alternating direction method of multipliers, Foundations and Trends in
  /// Machine Learning 3 (2011) 1-122, sections 3.1.1 and 5.
  /// @param from_ends  s, of rows that are looked at
  /// @pre it begins and ends at rest
  std::vector<Joints> nearest_within(
      std::vector<Joints> u, double from_ends = std::numeric_limits<double>::infinity()) const;

 private:
  struct Range {
    double low = 0.0, high = 0.0;
  };
  static constexpr std::size_t kOrders = 3;

  Range of_path(std::size_t order, std::size_t row, int joint) const;
  Range left(std::size_t order, std::size_t row, int joint) const;
  double beyond(const std::vector<double>& u, std::size_t row, int joint) const;
  void bring_within(std::vector<double>& u, std::size_t from, std::size_t to, int joint) const;

  std::array<Joints, kOrders> limits_;  // v, a, j
  double h_;                            // s, between two rows
  std::vector<PathRange> path_;
};

/// Share of a limit by which rounding may exceed it.
inline constexpr double kLimitRounding = 1e-3;

/// True if demands keep limits, up to rounding.
bool keeps(const controllers::JointLimits& demands, const controllers::JointLimits& limits);

/// Limits with which to plan the path anew, so that path and offset together may keep theirs.
/// @param planned  with which it was planned
controllers::JointLimits lowered(const controllers::JointLimits& planned,
                                 const controllers::JointLimits& demands,
                                 const controllers::JointLimits& limits);

}  // namespace servomill::sim::preparation
