#include "plant/vocabulary/move_curve.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/spline_curve.h"

namespace servomill {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

MoveCurve::MoveCurve(const AxisWords& from, const Move& move) : from_(from), to_(move.end_machine) {
  assert(is_motion(move.kind));
  if (move.kind == MoveKind::arc && move.plane) {
    plane_ = move.plane;
    const Eigen::Vector3d begin = plane_->R.transpose() * (from.head<3>() - plane_->origin);
    arc_ =
        ArcSweep(begin, move.end.head<3>(), move.arc.centre, move.arc.normal_axis, move.arc.turns);
  } else if (move.kind == MoveKind::arc) {
    arc_ = arc_sweep(move, from.head<3>());
  } else if (move.kind == MoveKind::spline) {
    spline_ = move.spline;
  }
  length_ = arc_      ? arc_->length()
            : spline_ ? spline_->curve.length()
                      : (to_ - from_).head<3>().norm();
}

MoveCurve::MoveCurve(const AxisWords& from, const AxisWords& to)
    : from_(from), to_(to), length_((to_ - from_).head<3>().norm()) {}

AxisWords MoveCurve::at(double t) const {
  if (t >= 1.0) return to_;
  AxisWords p = from_ + t * (to_ - from_);
  if (arc_) p.head<3>() = arc_->point(t);
  if (spline_) p.head<3>() = spline_->curve.point(t * length_);
  if (plane_) p.head<3>() = plane_->R * p.head<3>() + plane_->origin;
  return p;
}

double MoveCurve::sweep() const { return arc_ ? std::abs(arc_->sweep) : 0.0; }

double MoveCurve::closest(const Eigen::Vector3d& point) const {
  if (spline_) return length_ > 0.0 ? spline_->curve.closest(point) / length_ : 1.0;
  if (!arc_) {
    const Eigen::Vector3d d = (to_ - from_).head<3>();
    const double dd = d.squaredNorm();
    if (dd == 0.0) return 1.0;
    return std::clamp(d.dot(point - from_.head<3>()) / dd, 0.0, 1.0);
  }
  const Eigen::Vector3d p =
      plane_ ? Eigen::Vector3d(plane_->R.transpose() * (point - plane_->origin)) : point;
  // angle from the start in the sense of the arc, on the revolution that is nearest along the axis
  const ArcSweep& arc = *arc_;
  const double pitch = arc.along_end - arc.along_begin;
  const double axial =
      pitch != 0.0 ? std::clamp((p[arc.c] - arc.along_begin) / pitch, 0.0, 1.0) : 0.5;
  const double angle = std::atan2(p[arc.b] - arc.centre_b, p[arc.a] - arc.centre_a) - arc.angle;
  const double nearest = angle + kTurn * std::round((axial * arc.sweep - angle) / kTurn);
  return std::clamp(nearest / arc.sweep, 0.0, 1.0);
}

}  // namespace servomill
