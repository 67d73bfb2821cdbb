/// The body that a cutter sweeps on its straight way from one position to the next.
///
/// A point x of the workpiece, seen from the cutter, goes from y_a = x - p_a to y_b = Q^T (x -
/// p_b), Q the smallest rotation that takes the axis k_a to k_b. It is swept if it is inside of the
/// cutter somewhere on the straight way between them:
///
///     y(t) = y_a - t w,  w = y_a - y_b,  0 <= t <= 1                                          (1)
///
/// Without a turn of the axis this is exact (w = p_b - p_a); with one, the way is bent by less than
/// turn_deviation(). For a fixed axis the body is a convex one moved along a segment: convex
/// itself, so that a straight line meets it in one stretch at most.
#pragma once

#include <Eigen/Core>

#include "plant/cutting/cutter.h"

namespace servomill::plant {

/// The body of revolution of a cutter: a disc of radius `disc` at height `centre`, rounded by
/// `corner`, and the cylinder from it to `top`.
struct Envelope {
  double disc = 0.0;    // R - r, m
  double corner = 0.0;  // r, m
  double centre = 0.0;  // m above the tip
  double top = 0.0;     // m above the tip

  double radius() const { return disc + corner; }
  /// No point is farther than this from the tip (m).
  double reach() const;
};

/// The cutter, or a body that holds everything within `margin` (m, >= 0) of it.
Envelope envelope(const Cutter& cutter, double margin = 0.0);

/// Bound (m) of what (1) leaves out as the axis turns on the way from a to b: a^2 reach / 8 +
/// a |p_b - p_a| / 4 for an angle a, from the second derivative of y.
double turn_deviation(const CutterPosition& a, const CutterPosition& b, double reach);

/// Chord of the angle between the axes of two positions, 2 sin(angle / 2).
double chord_of_turn(const CutterPosition& a, const CutterPosition& b);

/// The points start + s direction, 0 <= s <= length.
struct Ray {
  Eigen::Vector3d start, direction;  // m; unit
  double length = 0.0;               // m

  Eigen::Vector3d at(double s) const { return start + s * direction; }
};

/// @pre unit axes, less than 90 deg apart
class SweptCutter {
 public:
  SweptCutter(const Envelope& body, const CutterPosition& a, const CutterPosition& b);

  bool contains(const Eigen::Vector3d& x) const;

  /// Distance s (m) at which the line of the ray leaves the body, also beyond the ray's ends;
  /// -infinity if it misses it. It enters at -leave(reversed, ...).
  ///
  /// As the axis turns, w of (1) changes along the line: it is taken at s_near, so that the result
  /// s is exact for s_near = s, and wrong by no more than what a body does that is displaced by |s
  /// - s_near| turn() across the line.
  double leave(const Ray& ray, double s_near) const;

  /// Quickly a bound of leave(ray, s_near); -infinity if that is not beyond `beyond`.
  double leave_bound(const Ray& ray, double s_near, double beyond) const;

  bool turns() const { return !turn_.isZero(0.0); }

 private:
  Eigen::Vector3d way_of(const Eigen::Vector3d& y_a) const;  // w of a point at y_a
  double leave_cylinder(const Eigen::Vector3d& y, const Eigen::Vector3d& d,
                        const Eigen::Vector3d& w) const;
  double leave_ball(const Eigen::Vector3d& y, const Eigen::Vector3d& d,
                    const Eigen::Vector3d& w) const;
  double leave_rounded_disc(const Eigen::Vector3d& y, const Eigen::Vector3d& d,
                            const Eigen::Vector3d& w) const;

  Envelope body_;
  Eigen::Vector3d p_a_, k_, v_;
  Eigen::Vector3d turn_;  // k_a x k_b
  double cosine_;         // k_a . k_b
};

}  // namespace servomill::plant
