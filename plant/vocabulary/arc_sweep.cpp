#include "plant/vocabulary/arc_sweep.h"

#include <cassert>
#include <cmath>
#include <numbers>

namespace servomill {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kSameAngle = 1e-9;  // rad: an arc that ends where it began is a full turn

// From (x0, y0) to (x1, y1), |turns| started revolutions; signed.
double swept_angle(double x0, double y0, double x1, double y1, int turns) {
  const double side = turns > 0 ? 1.0 : -1.0;
  double turned = side * std::atan2(x0 * y1 - y0 * x1, x0 * x1 + y0 * y1);
  if (turned <= kSameAngle) turned += kTurn;
  return side * (turned + kTurn * (std::abs(turns) - 1));
}

}  // namespace

ArcSweep::ArcSweep(const Eigen::Vector3d& begin, const Eigen::Vector3d& end,
                   const Eigen::Vector3d& centre, int normal_axis, int turns)
    : a((normal_axis + 1) % 3),
      b((normal_axis + 2) % 3),
      c(normal_axis),
      centre_a(centre[a]),
      centre_b(centre[b]),
      along_begin(begin[c]),
      along_end(end[c]) {
  assert(turns != 0);
  const double x0 = begin[a] - centre_a, y0 = begin[b] - centre_b;
  const double x1 = end[a] - centre_a, y1 = end[b] - centre_b;
  r_begin = std::hypot(x0, y0);
  r_end = std::hypot(x1, y1);
  angle = std::atan2(y0, x0);
  sweep = swept_angle(x0, y0, x1, y1, turns);
}

ArcSweep arc_sweep(const Move& move, const Eigen::Vector3d& begin) {
  assert(move.kind == MoveKind::arc);
  return {begin, move.end_machine.head<3>(), move.centre_machine, move.arc.normal_axis,
          move.arc.turns};
}

Eigen::Vector3d ArcSweep::point(double fraction) const {
  const double r = radius(fraction), phi = angle + sweep * fraction;
  Eigen::Vector3d p;
  p[a] = centre_a + r * std::cos(phi);
  p[b] = centre_b + r * std::sin(phi);
  p[c] = along_begin + (along_end - along_begin) * fraction;
  return p;
}

Eigen::Vector3d ArcSweep::derivative(double fraction) const {
  const double r = radius(fraction), dr = r_end - r_begin, phi = angle + sweep * fraction;
  Eigen::Vector3d dp;
  dp[a] = dr * std::cos(phi) - r * sweep * std::sin(phi);
  dp[b] = dr * std::sin(phi) + r * sweep * std::cos(phi);
  dp[c] = along_end - along_begin;
  return dp;
}

double ArcSweep::length() const { return std::hypot(sweep * radius(0.5), along_end - along_begin); }

}  // namespace servomill
