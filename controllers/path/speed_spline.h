/// The square of the speed along a path as a quadratic spline.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace servomill::controllers {

/// b(s) = v^2 on the intervals between knots; N of them have N + 1 knots and N + 2 coefficients,
/// three for each interval. Beyond its ends the knots are mirrored.
struct SpeedSpline {
  using State = Eigen::Vector3d;  // b, b', b''

  std::vector<double> t;  // m, knots
  std::vector<double> c;  // m^2/s^2

  std::size_t intervals() const { return t.size() - 1; }
  double knot(std::ptrdiff_t i) const;
  /// Three coefficients -> state where the interval begins.
  Eigen::Matrix3d matrix(std::size_t interval) const;
  State begin_of(std::size_t interval) const {
    return matrix(interval) * State(c[interval], c[interval + 1], c[interval + 2]);
  }
  /// y metres on.
  static State shifted(const State& x, double y) {
    return {x[0] + y * (x[1] + 0.5 * y * x[2]), x[1] + y * x[2], x[2]};
  }
  /// s, of an interval that begins with that state.
  double duration(std::size_t interval, const State& begin) const;
};

}  // namespace servomill::controllers
