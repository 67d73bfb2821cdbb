/// Programs for the tests of the path planner, written as canonical moves.
#pragma once

#include <vector>

#include "controllers/path/path_limits.h"
#include "controllers/path/trajectory.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::test {

inline const JointLayout kLayout{{Axis::X, Axis::Y, Axis::Z, Axis::B, Axis::C}};

/// 40 m/min; 6, 7, 8 m/s^2; 100 m/s^3; 100 and 200 rpm; 50 and 100 rad/s^2.
inline JointLimits machine_limits() {
  JointLimits limits;
  limits.v << 40.0 * m_per_min, 40.0 * m_per_min, 40.0 * m_per_min, 100.0 * rpm, 200.0 * rpm;
  limits.a << 6.0, 7.0, 8.0, 50.0, 100.0;
  limits.j << 100.0, 100.0, 100.0, 1000.0, 2000.0;
  return limits;
}

/// Appends moves one after the other; s runs along the path.
class Program {
 public:
  explicit Program(const Joints& start = Joints::Zero())
      : start_(start), at_(kLayout.words(start)) {}

  PathMode path_mode = PathMode::continuous;
  double path_tolerance = 0.0;

  Program& line(const AxisWords& to, double feed);
  Program& line(double x, double y, double z, double feed);
  Program& rapid(const AxisWords& to);
  Program& arc(const Eigen::Vector3d& centre, const Eigen::Vector3d& to, int normal, int turns,
               double feed);
  /// @param points   X Y behind where it begins, of a NURBS of that order
  /// @param weights  of the start and of each of these; all 1 if empty
  Program& spline(int order, const std::vector<Eigen::Vector2d>& points, double feed,
                  std::vector<double> weights = {});
  Program& dwell(double seconds);

  const std::vector<Move>& moves() const { return moves_; }
  const Joints& start() const { return start_; }
  const AxisWords& at() const { return at_; }
  Trajectory plan(const PathOptions& options = {},
                  const JointLimits& limits = machine_limits()) const {
    return controllers::plan(moves_, kLayout, start_, limits, options);
  }

 private:
  void append(Move move, double length);

  Joints start_;
  AxisWords at_;
  double s_ = 0.0;
  std::vector<Move> moves_;
};

/// Lines, arcs and helices, rapids, reversals, tiny blocks, dwells, all path modes; sizes from
/// 1 um to 50 mm. The same seed gives the same program.
Program random_program(unsigned seed);

/// Time (s) of the fastest motion along the smoothed path of `trajectory` under the limits of
/// velocity and acceleration alone, and no faster than each joint with limited jerk gets from the
/// begin to the end of each chain: no motion along this path with these stops is faster. Two passes
/// over the squared speed, after Pham and Pham, "A new approach to time-optimal path
/// parameterization based on reachability analysis", IEEE T-RO 34(3), 2018.
double time_bound(const Trajectory& trajectory, const std::vector<Move>& moves,
                  const JointLimits& limits, const PathOptions& options);

}  // namespace servomill::controllers::test
