/// Measured points, and how they lie.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>

namespace servomill::sim::metrology {

/// Points of a plane; coordinates in one unit, m where it matters.
using Points2 = std::span<const Eigen::Vector2d>;
/// Points of space, likewise.
using Points3 = std::span<const Eigen::Vector3d>;

/// Least and greatest of signed distances.
struct Spread {
  double low = 0.0, high = 0.0;
  double range() const { return high - low; }
};

/// Distances of points from a shape, with the sign that shape.distance(p) gives them. Straightness,
/// flatness, roundness ... about a shape are the range.
/// @pre there are points
template <typename Points, typename Shape>
Spread spread_about(const Points& points, const Shape& shape) {
  Spread out{shape.distance(points.front()), shape.distance(points.front())};
  for (const auto& p : points) {
    out.low = std::min(out.low, shape.distance(p));
    out.high = std::max(out.high, shape.distance(p));
  }
  return out;
}

/// Mean of points, the directions in which they extend, and how far.
template <int N>
struct PrincipalAxes {
  Eigen::Vector<double, N> mean = Eigen::Vector<double, N>::Zero();
  Eigen::Matrix<double, N, N> axes = Eigen::Matrix<double, N, N>::Identity();  // unit columns
  Eigen::Vector<double, N> extent = Eigen::Vector<double, N>::Zero();          // rms, falling

  /// True if the points extend in at least `count` directions, by more than rounding.
  bool span_directions(int count) const;
};

/// @pre there are points
PrincipalAxes<2> principal_axes(Points2 points);
PrincipalAxes<3> principal_axes(Points3 points);

/// A unit vector across a unit vector; the same for the same.
Eigen::Vector3d across(const Eigen::Vector3d& unit);

}  // namespace servomill::sim::metrology
