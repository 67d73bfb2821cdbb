#include "plant/vocabulary/move_curve.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace servomill {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kSameAngle = 1e-9;  // rad: an arc that ends where it began is a full turn

// Signed angle of an arc that turns from (x0, y0) to (x1, y1), |turns| started revolutions.
double sweep_angle(double x0, double y0, double x1, double y1, int turns) {
  double sweep = std::atan2(x0 * y1 - y0 * x1, x0 * x1 + y0 * y1);
  if (turns > 0) return sweep + (sweep <= kSameAngle ? kTurn : 0.0) + kTurn * (turns - 1);
  return sweep - (sweep >= -kSameAngle ? kTurn : 0.0) + kTurn * (turns + 1);
}

}  // namespace

MoveCurve::MoveCurve(const AxisWords& from, const Move& move)
    : from_(from), to_(move.end_machine), is_arc_(move.kind == MoveKind::arc) {
  assert(is_motion(move.kind));
  const Eigen::Vector3d d = (to_ - from_).head<3>();
  length_ = d.norm();
  if (!is_arc_) return;
  const int n = move.arc.normal_axis;
  u_ = (n + 1) % 3;
  v_ = (n + 2) % 3;
  cu_ = move.centre_machine[u_];
  cv_ = move.centre_machine[v_];
  const double x0 = from_[u_] - cu_, y0 = from_[v_] - cv_;
  const double x1 = to_[u_] - cu_, y1 = to_[v_] - cv_;
  r0_ = std::hypot(x0, y0);
  r1_ = std::hypot(x1, y1);
  phi0_ = std::atan2(y0, x0);
  sweep_ = sweep_angle(x0, y0, x1, y1, move.arc.turns);
  length_ = std::hypot(sweep_ * 0.5 * (r0_ + r1_), d[n]);
}

AxisWords MoveCurve::at(double t) const {
  if (t >= 1.0) return to_;
  AxisWords p = from_ + t * (to_ - from_);
  if (!is_arc_) return p;
  const double r = r0_ + t * (r1_ - r0_), phi = phi0_ + t * sweep_;
  p[u_] = cu_ + r * std::cos(phi);
  p[v_] = cv_ + r * std::sin(phi);
  return p;
}

double MoveCurve::closest(const Eigen::Vector3d& p) const {
  if (!is_arc_) {
    const Eigen::Vector3d d = (to_ - from_).head<3>();
    const double dd = d.squaredNorm();
    if (dd == 0.0) return 1.0;
    return std::clamp(d.dot(p - from_.head<3>()) / dd, 0.0, 1.0);
  }
  if (sweep_ == 0.0) return 1.0;
  // angle from the start in the sense of the arc, on the revolution that is nearest along the axis
  const int n = 3 - u_ - v_;
  const double pitch = to_[n] - from_[n];
  const double axial = pitch != 0.0 ? std::clamp((p[n] - from_[n]) / pitch, 0.0, 1.0) : 0.5;
  const double angle = std::atan2(p[v_] - cv_, p[u_] - cu_) - phi0_;
  const double nearest = angle + kTurn * std::round((axial * sweep_ - angle) / kTurn);
  return std::clamp(nearest / sweep_, 0.0, 1.0);
}

}  // namespace servomill
