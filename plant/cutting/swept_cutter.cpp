#include "plant/cutting/swept_cutter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace servomill::plant {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeaveTolerance = 1e-16;  // m
constexpr int kMaxIterations = 60;  // of a Newton that halves an interval where it would leave it

// An interval; empty if from > to.
struct Range {
  double from = kInfinity, to = -kInfinity;

  bool empty() const { return !(from <= to); }
  Range within(const Range& other) const {
    return {std::max(from, other.from), std::min(to, other.to)};
  }
};

constexpr Range kEverything = {-kInfinity, kInfinity};
constexpr Range kWay = {0.0, 1.0};

// The range of u with |A + u B| <= rho.
Range inside_ball(const Vector3d& A, const Vector3d& B, double rho) {
  const double a = B.squaredNorm(), b = A.dot(B), c = A.squaredNorm() - rho * rho;
  if (a < std::numeric_limits<double>::min()) return c <= 0.0 ? kEverything : Range{};
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) return {};
  const double q = -b - std::copysign(std::sqrt(discriminant), b);
  const double u = q / a, other = q == 0.0 ? 0.0 : c / q;
  return {std::min(u, other), std::max(u, other)};
}

// The range of u with from <= a + u b <= to.
Range inside_slab(double a, double b, const Range& heights) {
  if (b == 0.0) return heights.from <= a && a <= heights.to ? kEverything : Range{};
  const double u = (heights.from - a) / b, other = (heights.to - a) / b;
  return {std::min(u, other), std::max(u, other)};
}

Vector3d across(const Vector3d& y, const Vector3d& k) { return y - k * k.dot(y); }

// The straight way y - t w of a point past a disc of radius `disc` about the origin, normal k.
struct WayPastDisc {
  double disc;
  double h_0, dh;    // height y . k and its change w . k
  Vector3d P_0, dP;  // y and w across k

  double distance(double t) const {
    const double excess = (P_0 - t * dP).norm() - disc;
    return std::hypot(std::max(excess, 0.0), h_0 - t * dh);
  }

  // Half the first and second derivative of distance^2, which is convex.
  std::pair<double, double> slope(double t) const {
    const Vector3d P = P_0 - t * dP;
    const double rho = P.norm(), h = h_0 - t * dh;
    if (rho <= disc) return {-h * dh, dh * dh};
    const double drho = -P.dot(dP) / rho;
    return {(rho - disc) * drho - h * dh,
            drho * drho + (1.0 - disc / rho) * (dP.squaredNorm() - drho * drho) + dh * dh};
  }

  // Fraction of the path, 0 to 1, at which the disc is nearest.
  double nearest(double t) const {
    if (slope(0.0).first >= 0.0) return 0.0;
    if (slope(1.0).first <= 0.0) return 1.0;
    double before = 0.0, after = 1.0;
    for (int i = 0; i < kMaxIterations; ++i) {
      const auto [first, second] = slope(t);
      (first < 0.0 ? before : after) = t;
      double next = t - first / second;
      if (!(before < next && next < after)) next = 0.5 * (before + after);
      if (std::abs(next - t) < 1e-12) return next;
      t = next;
    }
    return t;
  }
};

}  // namespace

double Envelope::reach() const { return std::hypot(radius(), std::max(top, corner - centre)); }

Envelope envelope(const Cutter& cutter, double margin) {
  const double r = cutter.corner_radius;
  // a flat cutter stays flat: simpler, and larger than need be only at its edge
  if (cutter.is_flat()) return {cutter.radius + margin, 0.0, -margin, cutter.length + margin};
  return {cutter.radius - r, r + margin, r, cutter.length + margin};
}

double turn_deviation(const CutterPosition& a, const CutterPosition& b, double reach) {
  const double angle = std::atan2(a.axis.cross(b.axis).norm(), a.axis.dot(b.axis));
  return angle * (angle * reach / 8.0 + (b.tip - a.tip).norm() / 4.0);
}

double chord_of_turn(const CutterPosition& a, const CutterPosition& b) {
  return (b.axis - a.axis).norm();
}

SweptCutter::SweptCutter(const Envelope& body, const CutterPosition& a, const CutterPosition& b)
    : body_(body),
      p_a_(a.tip),
      k_(a.axis),
      v_(b.tip - a.tip),
      turn_(a.axis.cross(b.axis)),
      cosine_(a.axis.dot(b.axis)) {
  assert(cosine_ > 0.0);
}

Vector3d SweptCutter::way_of(const Vector3d& y_a) const {
  if (!turns()) return v_;
  const Vector3d y = y_a - v_, turned = turn_.cross(y);
  return v_ + turned - turn_.cross(turned) / (1.0 + cosine_);
}

bool SweptCutter::contains(const Vector3d& x) const {
  const Vector3d y = x - p_a_, w = way_of(y);
  const double h = k_.dot(y), dh = k_.dot(w);
  const Vector3d P = across(y, k_), dP = across(w, k_);

  // the cylinder
  const Range high = kWay.within(inside_slab(h, -dh, {body_.centre, body_.top}));
  if (!high.within(inside_ball(P, -dP, body_.radius())).empty()) return true;
  if (body_.corner == 0.0) return false;

  // the rounded disc below it; above the flutes it has only what the cylinder has, too
  const Range below_top = kWay.within(inside_slab(h, -dh, {-kInfinity, body_.top}));
  if (body_.disc == 0.0) {
    return !below_top.within(inside_ball(y - body_.centre * k_, -w, body_.corner)).empty();
  }
  const WayPastDisc way = {body_.disc, h - body_.centre, dh, P, dP};
  const double t = way.nearest(0.5);
  return h - t * dh <= body_.top && way.distance(t) <= body_.corner;
}

// In the plane of s and t, what is swept is convex: leaving it is the largest s.
double SweptCutter::leave(const Ray& ray, double s_near) const {
  const Vector3d y = ray.start - p_a_, d = ray.direction;
  const Vector3d w = way_of(y + s_near * d);
  const double cylinder = leave_cylinder(y, d, w);
  if (body_.corner == 0.0) return cylinder;
  return std::max(cylinder, body_.disc == 0.0 ? leave_ball(y, d, w) : leave_rounded_disc(y, d, w));
}

// On its way down, a ray does not leave below the bottom; up to there it is within the radius of
// the axis only if it is nearly so at once. Under the disc, that is where it leaves.
double SweptCutter::leave_bound(const Ray& ray, double s_near, double beyond) const {
  constexpr double kSteep = -0.3;
  const Vector3d y = ray.at(beyond) - p_a_, d = ray.direction;
  const Vector3d w = way_of(y + (s_near - beyond) * d);
  const double h_s = k_.dot(d), dh = k_.dot(w);
  if (h_s >= kSteep) return leave(ray, s_near);
  const double above = k_.dot(y) - std::min(dh, 0.0) - (body_.centre - body_.corner);
  if (above < 0.0) return -kInfinity;
  const Vector3d P = across(y, k_), dP = across(w, k_);
  const double way = dP.squaredNorm();
  const double t = way > 0.0 ? std::clamp(P.dot(dP) / way, 0.0, 1.0) : 0.0;
  const double to_bottom = above / -h_s,
               aside = to_bottom * std::sqrt(std::max(1.0 - h_s * h_s, 0.0));
  const double rho = (P - t * dP).norm();
  if (rho > body_.radius() + aside) return -kInfinity;
  if (body_.corner == 0.0 || rho + aside < body_.disc) return beyond + to_bottom;
  return leave(ray, s_near);
}

// The heights and 0 <= t <= 1 bound a parallelogram of the plane of s and t, the radius an ellipse:
// the largest s of both is on an edge of the one or the tip of the other.
double SweptCutter::leave_cylinder(const Vector3d& y, const Vector3d& d, const Vector3d& w) const {
  const double h = k_.dot(y), h_s = k_.dot(d), h_t = -k_.dot(w);
  const Vector3d P = across(y, k_), P_s = across(d, k_), P_t = -across(w, k_);
  const Range heights = {body_.centre, body_.top};
  const double R = body_.radius();
  double s = -kInfinity;

  // edges of the way: t = 0 and t = 1
  for (const double t : {0.0, 1.0}) {
    const Range range =
        inside_slab(h + t * h_t, h_s, heights).within(inside_ball(P + t * P_t, P_s, R));
    if (!range.empty()) s = std::max(s, range.to);
  }

  // edges of the height: s = s_0 - u h_t, t = t_0 + u h_s
  const double squares = h_s * h_s + h_t * h_t;
  if (squares > 0.0) {
    for (const double height : {heights.from, heights.to}) {
      const double s_0 = (height - h) * h_s / squares, t_0 = (height - h) * h_t / squares;
      const Range range =
          inside_slab(t_0, h_s, kWay)
              .within(inside_ball(P + s_0 * P_s + t_0 * P_t, h_s * P_t - h_t * P_s, R));
      if (!range.empty()) s = std::max(s, s_0 - h_t * (h_t > 0.0 ? range.from : range.to));
    }
  }

  // between them: the line touches the plane, parallel to the way, in which the flank moves
  const double way = P_t.squaredNorm();
  if (way > 0.0) {
    const Range range =
        inside_ball(P - P_t * (P_t.dot(P) / way), P_s - P_t * (P_t.dot(P_s) / way), R);
    const double t = -P_t.dot(P + range.to * P_s) / way, height = h + range.to * h_s + t * h_t;
    if (0.0 <= t && t <= 1.0 && heights.from <= height && height <= heights.to) {
      s = std::max(s, range.to);
    }
  }
  return s;
}

// Above the top, where it does not cut, the ball is within the cylinder: what the ball itself would
// let leave there, does so in no other place than the cylinder's top.
double SweptCutter::leave_ball(const Vector3d& y, const Vector3d& d, const Vector3d& w) const {
  const Vector3d P = y - body_.centre * k_;
  double s = -kInfinity, t_of_s = 0.0;
  const auto consider = [&](double candidate, double t) {
    if (candidate > s) s = candidate, t_of_s = t;
  };
  for (const double t : {0.0, 1.0}) consider(inside_ball(P - t * w, d, body_.corner).to, t);
  const double way = w.squaredNorm();
  if (way > 0.0) {
    const double side =
        inside_ball(P - w * (w.dot(P) / way), d - w * (w.dot(d) / way), body_.corner).to;
    const double t = w.dot(P + side * d) / way;
    if (0.0 <= t && t <= 1.0) consider(side, t);
  }
  return k_.dot(y + s * d - t_of_s * w) <= body_.top ? s : -kInfinity;
}

// The distance of the line's points from the disc, wherever on the way it is nearest, is convex in
// s: Newton's method comes down to the radius of the corner from outside, and nowhere leaps over
// it.
double SweptCutter::leave_rounded_disc(const Vector3d& y, const Vector3d& d,
                                       const Vector3d& w) const {
  const double h = k_.dot(y) - body_.centre, h_s = k_.dot(d), dh = k_.dot(w);
  const Vector3d P = across(y, k_), P_s = across(d, k_), dP = across(w, k_);
  const double support = body_.disc * P_s.norm() + body_.corner + std::max(0.0, w.dot(d));
  double s = support - (d.dot(y) - body_.centre * h_s), t = 0.5;
  for (int i = 0;; ++i) {
    if (i == kMaxIterations) return -kInfinity;  // passes by
    const WayPastDisc way = {body_.disc, h + s * h_s, dh, P + s * P_s, dP};
    t = way.nearest(t);
    const Vector3d Q = way.P_0 - t * dP;
    const double rho = Q.norm(), height = way.h_0 - t * dh;
    const double excess = std::max(rho - body_.disc, 0.0);
    const double distance = std::hypot(excess, height), over = distance - body_.corner;
    if (over <= kLeaveTolerance) break;
    const double across_slope = excess > 0.0 ? excess * Q.dot(P_s) / rho : 0.0;
    const double slope = (across_slope + height * h_s) / distance;
    if (slope <= 0.0) return -kInfinity;
    s -= over / slope;
  }
  return h + s * h_s - t * dh + body_.centre <= body_.top ? s : -kInfinity;
}

}  // namespace servomill::plant
