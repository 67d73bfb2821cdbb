#include "controllers/path/speed_spline.h"

#include <cmath>

namespace servomill::controllers {

double SpeedSpline::knot(std::ptrdiff_t i) const {
  const auto n = static_cast<std::ptrdiff_t>(intervals());
  const auto at = [&](std::ptrdiff_t k) { return t[static_cast<std::size_t>(k)]; };
  if (i < 0) return 2.0 * at(0) - at(-i);
  if (i > n) return 2.0 * at(n) - at(2 * n - i);
  return at(i);
}

Eigen::Matrix3d SpeedSpline::matrix(std::size_t interval) const {
  const auto n = static_cast<std::ptrdiff_t>(interval);
  const double before = knot(n - 1), at = knot(n), next = knot(n + 1), after = knot(n + 2);
  const double D = next - before, E = after - at, h = next - at;
  Eigen::Matrix3d P;
  P.row(0) << h / D, (at - before) / D, 0.0;
  P.row(1) << -2.0 / D, 2.0 / D, 0.0;
  P.row(2) << 2.0 / (D * h), -2.0 / (D * h) - 2.0 / (E * h), 2.0 / (E * h);
  return P;
}

double SpeedSpline::duration(std::size_t interval, const State& x) const {
  const double h = t[interval + 1] - t[interval];
  const double v0 = std::sqrt(x[0]), v1 = std::sqrt(shifted(x, h)[0]);
  const double beta = 0.5 * x[2], r = h / (v0 + v1), z = beta * r * r;
  if (std::abs(z) < 1e-3) {
    return 2.0 * r * (1.0 + z * (1.0 / 3.0 + z * (0.2 + z * (1.0 / 7.0 + z / 9.0))));
  }
  const double root = std::sqrt(std::abs(beta));
  return 2.0 / root * (beta > 0.0 ? std::atanh(root * r) : std::atan(root * r));
}

}  // namespace servomill::controllers
