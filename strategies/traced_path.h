/// The path of a commanded point in the recent past, and the place on it that is nearest to another
/// point.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace servomill::strategies {

/// A polyline of the last commanded points. The place of one call is sought from that of the call
/// before, a little back and all the way forward: a tip that cuts a corner goes over to the second
/// leg. No allocation after construction.
class TracedPath {
 public:
  /// @param length  points that are held, at least 2
  explicit TracedPath(std::size_t length);

  /// Restarts at p.
  void start(const Eigen::Vector3d& p);
  /// The point has moved to p. A step of less than kShortest is none.
  void add(const Eigen::Vector3d& p);

  struct Place {
    Eigen::Vector3d point;    // m
    Eigen::Vector3d tangent;  // unit, in the direction of travel
  };
  /// The place nearest to a; before the oldest and after the last point the path goes on straight.
  /// @pre has_moved()
  Place nearest(const Eigen::Vector3d& a);
  bool has_moved() const { return count_ > 1; }

  static constexpr double kShortest = 1e-9;  // m

 private:
  struct Point {
    Eigen::Vector3d p;
    double length = 0.0;  // m, of the path up to it
  };
  const Point& point(std::size_t n) const {  // 0: the oldest
    return points_[(oldest_ + n) % points_.size()];
  }
  // Nearest point of a chord: its place in [0, 1] and the square of the distance.
  struct Foot {
    double t, square;
  };
  Foot foot(std::size_t chord, const Eigen::Vector3d& a) const;

  void look_ahead(const Eigen::Vector3d& a, Foot& now);

  std::vector<Point> points_;
  std::size_t oldest_ = 0, count_ = 0;
  std::size_t near_ = 0;  // chord of the last place
};

}  // namespace servomill::strategies
