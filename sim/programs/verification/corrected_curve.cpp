#include "sim/programs/verification/corrected_curve.h"

#include <algorithm>
#include <cmath>

namespace servomill::sim::programs {
namespace {

using Eigen::Vector3d;

constexpr double kStill = 1e-12;  // m, rad: what rounding leaves of positions
constexpr double kFlat = 1e-8;    // m: an arc with a smaller radius has no angle

// Rotations as the displacement of a point at a lever.
AxisWords weighted(AxisWords v) {
  constexpr double kLever = 0.1;  // m/rad, as tolerances of rotary axes
  v.tail<3>() *= kLever;
  return v;
}

double angle_between(const ArcSweep& arc, const AxisWords& from, const AxisWords& end) {
  const double ax = from[arc.a] - arc.centre_a, ay = from[arc.b] - arc.centre_b;
  const double bx = end[arc.a] - arc.centre_a, by = end[arc.b] - arc.centre_b;
  return std::atan2(ax * by - ay * bx, ax * bx + ay * by);
}

}  // namespace

CorrectedCurve::CorrectedCurve(const OriginalAction& action, const Correction& correction)
    : correction_(correction),
      begin_(action.begin),
      end_(action.move.end_machine),
      s_begin_(action.move.s_begin),
      s_end_(action.move.s_end) {
  if (action.move.kind == MoveKind::arc) {
    arc_ = arc_sweep(action.move, begin_.head<3>());
    if (arc_->r_begin < kFlat) arc_.reset();
  }
  length_ = arc_ ? arc_->length() : (end_ - begin_).head<3>().norm();
  angle_ = (end_ - begin_).tail<3>().norm();
  if (length_ < kStill) length_ = 0.0;
  if (angle_ < kStill) angle_ = 0.0;
}

AxisWords CorrectedCurve::programmed(double t) const {
  AxisWords out = begin_ + t * (end_ - begin_);
  if (arc_) out.head<3>() = arc_->point(t);
  return out;
}

AxisWords CorrectedCurve::at(double t) const {
  const AxisWords programmed_position = programmed(t);
  AxisWords out =
      programmed_position + correction_.at(programmed_position, s_begin_ + t * (s_end_ - s_begin_));
  for (int i = 0; i < kAxisWords; ++i) {
    if (is_held_[static_cast<std::size_t>(i)]) out[i] = held_[i];
  }
  return out;
}

void CorrectedCurve::hold(const AxisFlags6& axes, const AxisWords& position) {
  is_held_ = axes;
  held_ = position;
}

Vector3d CorrectedCurve::derivative(double t) const {
  return arc_ ? arc_->derivative(t) : Vector3d((end_ - begin_).head<3>());
}

// From share t to `end`. A straight block may come from beside the path, where a rapid has ended:
// its own length says nothing.
double CorrectedCurve::first_guess(const AxisWords& from, const AxisWords& end, double t,
                                   const controllers::MachineAction& action) const {
  if (!arc_) {
    const AxisWords along = weighted(end_ - begin_);
    return weighted(end - at(t)).dot(along) / along.squaredNorm();
  }
  const bool is_arc = action.kind == controllers::ActionKind::arc && action.normal_axis == arc_->c;
  if (!is_arc) return angle_between(*arc_, at(t), end) / arc_->sweep;
  return ArcSweep(from.head<3>(), end.head<3>(), action.centre, arc_->c, action.turns).sweep /
         arc_->sweep;
}

double CorrectedCurve::share(const AxisWords& from, const AxisWords& end, double t,
                             const controllers::MachineAction& action) const {
  constexpr int kIterations = 2;  // the derivative is that of the programmed path
  double out = t + (is_still() ? 0.0 : first_guess(from, end, t, action));
  for (int i = 0; i < kIterations && !is_still(); ++i) {
    const double inside = std::clamp(out, 0.0, 1.0);
    AxisWords along = end_ - begin_;
    if (arc_) along.head<3>() = arc_->derivative(inside);
    along = weighted(along);
    const double step = weighted(end - at(inside)).dot(along) / along.squaredNorm();
    out += std::clamp(step + inside - out, -0.25, 0.25);
  }
  return out;
}

double CorrectedCurve::distance(const AxisWords& position, double t) const {
  Vector3d off = (position - at(t)).head<3>();
  if (rotates() || length_ == 0.0) return off.norm();
  if (arc_) {  // to where the position is abreast of the path
    const Vector3d along = derivative(t);
    t = std::clamp(t + off.dot(along) / along.squaredNorm(), 0.0, 1.0);
    off = (position - at(t)).head<3>();
  }
  const Vector3d e = derivative(t).normalized();
  off -= off.dot(e) * e;
  return off.norm();
}

double CorrectedCurve::turn(const AxisWords& position, double t) const {
  return (position - at(t)).tail<3>().cwiseAbs().maxCoeff();
}

}  // namespace servomill::sim::programs
