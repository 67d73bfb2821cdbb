#include <algorithm>

#include "plant/drives/exact_step.h"

namespace servomill::plant {
namespace {

// Fraction at which a straight line from a to b >= 0 reaches 0.
double rise(double a, double b) { return a >= 0.0 ? 0.0 : a / (a - b); }

// Change of the states over a time so short that two terms of the Taylor series do.
template <int kStates>
Eigen::Matrix<double, kStates, 1> taylor(const DriveEquations<kStates>& A,
                                         const Eigen::Matrix<double, kStates + 2, 1>& y,
                                         double dt) {
  const Eigen::Matrix<double, kStates, 1> rate = A * y;
  return dt * rate + 0.5 * dt * dt * (A.template leftCols<kStates>() * rate);
}

}  // namespace

// Over a short time, in the mode of the start.
LaneState ExactStep::coast(const LaneState& s, double command, double F, double dt) const {
  const Linear& linear = linear_of(s);
  const double delta = s.delta - contact_offset(params_, s.contact);
  const double f = sticks(s) ? 0.0 : force(s, F);
  LaneState next = s;
  const auto move = [&](const auto& change) {
    next.i += change[0];
    next.w += change[1];
    next.delta += change[2];
    next.v += change[3];
    next.x += change[change.size() - 1];
  };
  if (params_.on_bed()) {
    Eigen::Matrix<double, 9, 1> y;
    y << s.i, s.w, delta, s.v, s.bed_x, s.bed_v, 0.0, command, f;
    const Eigen::Matrix<double, 7, 1> change = taylor<7>(linear.on_bed, y, dt);
    move(change);
    next.bed_x += change[4];
    next.bed_v += change[5];
  } else {
    Eigen::Matrix<double, 7, 1> y;
    y << s.i, s.w, delta, s.v, 0.0, command, f;
    move(taylor<5>(linear.A, y, dt));
  }
  if (params_.friction.kind == FrictionKind::lugre) {
    next.z += dt * bristle_rate(params_.friction, s.v, s.z);
  }
  return next;
}

// The slide has stopped.
void ExactStep::from_rest(LaneState& s, double F) const {
  s.v = 0.0;
  if (params_.is_rigid()) s.w = 0.0;
  s.slide = slide_from_rest(params_.friction, driving_force(params_, s, F));
}

// Fraction of the step from s to end at which the slide stops or breaks away; 1: it does not.
double ExactStep::slide_event(const LaneState& s, const LaneState& end, double F) const {
  const FrictionParams& f = params_.friction;
  if (f.kind != FrictionKind::set_valued) return 1.0;
  if (sticks(s)) {
    const double D0 = driving_force(params_, s, F), D1 = driving_force(params_, end, F);
    if (D1 > f.Fs_positive) return rise(D0 - f.Fs_positive, D1 - f.Fs_positive);
    if (D1 < -f.Fs_negative) return rise(-D0 - f.Fs_negative, -D1 - f.Fs_negative);
    return 1.0;
  }
  const double v0 = direction(s.slide) * s.v, v1 = direction(s.slide) * end.v;
  return v1 < 0.0 ? rise(-v0, -v1) : 1.0;
}

// Fraction of the step at which a flank makes or loses contact; 1: it does not.
double ExactStep::contact_event(const LaneState& s, const LaneState& end) const {
  const ContactMode next = params_.gap > 0.0 ? contact_after(params_, end) : s.contact;
  if (next == s.contact) return 1.0;
  const ContactMode flank = next == ContactMode::gap ? s.contact : next;
  const double away = flank == ContactMode::positive ? 1.0 : -1.0;
  const double S0 = away * flank_force(params_, s, flank);
  const double S1 = away * flank_force(params_, end, flank);
  if (next == ContactMode::gap) return rise(-S0, -S1);
  const double offset = contact_offset(params_, flank);
  return std::max(rise(S0, S1), rise(away * (s.delta - offset), away * (end.delta - offset)));
}

// Through the finest sub-step, in which something happens: to the event, then on in the new mode.
void ExactStep::cross(LaneState& s, double command, double F) const {
  const LaneState end = coast(s, command, F, finest_);
  const double slide_at = slide_event(s, end, F), contact_at = contact_event(s, end);
  const double first = std::min(slide_at, contact_at);
  LaneState next = coast(s, command, F, first * finest_);
  if (first >= 1.0) {
    // it only grazed
  } else if (contact_at == first) {
    next.contact = contact_after(params_, end);
  } else if (sticks(s)) {
    const bool upwards = driving_force(params_, end, F) > params_.friction.Fs_positive;
    next.slide = upwards ? SlideMode::positive : SlideMode::negative;
  } else {
    from_rest(next, F);
  }
  s = coast(next, command, F, (1.0 - first) * finest_);
  const bool slides = params_.friction.kind == FrictionKind::set_valued && !sticks(s);
  if (slides && direction(s.slide) * s.v <= 0.0) from_rest(s, F);
}

}  // namespace servomill::plant
