#include "controllers/path/arc_sweep.h"

#include <cassert>
#include <cmath>
#include <numbers>

namespace servomill::controllers {
namespace {

constexpr double kSameAngle = 1e-8;  // rad
constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

ArcSweep arc_sweep(const Move& move, const Eigen::Vector3d& begin) {
  assert(move.kind == MoveKind::arc && move.arc.turns != 0);
  ArcSweep arc;
  arc.c = move.arc.normal_axis;
  arc.a = (arc.c + 1) % 3;
  arc.b = (arc.c + 2) % 3;
  arc.begin = begin;
  arc.end = move.end_machine.head<3>();
  arc.centre_a = move.centre_machine[arc.a];
  arc.centre_b = move.centre_machine[arc.b];
  const double a0 = begin[arc.a] - arc.centre_a, b0 = begin[arc.b] - arc.centre_b;
  const double a1 = arc.end[arc.a] - arc.centre_a, b1 = arc.end[arc.b] - arc.centre_b;
  arc.r_begin = std::hypot(a0, b0);
  arc.r_end = std::hypot(a1, b1);
  assert(arc.r_begin > 0.0 && arc.r_end > 0.0);
  arc.angle = std::atan2(b0, a0);
  const double side = move.arc.turns > 0 ? 1.0 : -1.0;
  double turned = side * (std::atan2(b1, a1) - arc.angle);
  while (turned <= kSameAngle) turned += kTurn;
  while (turned > kTurn + kSameAngle) turned -= kTurn;
  arc.sweep = side * (turned + kTurn * (std::abs(move.arc.turns) - 1));
  return arc;
}

Eigen::Vector3d ArcSweep::point(double fraction) const {
  if (fraction <= 0.0) return begin;
  if (fraction >= 1.0) return end;
  const double r = r_begin + (r_end - r_begin) * fraction, phi = angle + sweep * fraction;
  Eigen::Vector3d p;
  p[a] = centre_a + r * std::cos(phi);
  p[b] = centre_b + r * std::sin(phi);
  p[c] = begin[c] + (end[c] - begin[c]) * fraction;
  return p;
}

Eigen::Vector3d ArcSweep::derivative(double fraction) const {
  const double r = r_begin + (r_end - r_begin) * fraction, phi = angle + sweep * fraction;
  const double dr = r_end - r_begin;
  Eigen::Vector3d dp;
  dp[a] = dr * std::cos(phi) - r * sweep * std::sin(phi);
  dp[b] = dr * std::sin(phi) + r * sweep * std::cos(phi);
  dp[c] = end[c] - begin[c];
  return dp;
}

}  // namespace servomill::controllers
