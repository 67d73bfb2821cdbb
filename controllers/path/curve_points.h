/// Arcs and splines as the planner takes them: points on the curve, close enough together that the
/// smoothed path, which is pulled through them (smoothing_windows.h), is the curve.
///
/// A chord turns by at most 0.1 rad and is at most a quarter as long as the half-width of the
/// window that the tolerance T allows on the radius of curvature R,
///
///     h = min(0.1 R, sqrt(12 T R) / 4)                                                        (1)
///
/// A cubic through such points misses a circle by h^4 / (384 R^3), which is below T^2 / (680 R):
/// 0.15 nm for T = 10 um and R = 1 mm. Along a spline h changes by a quarter of the way at most;
/// where its curvature changes much, a cubic misses it by some 10 nm.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/spline_curve.h"

namespace servomill::controllers {

/// Angle (rad) of the chords of an arc of that radius (m), at most.
double chord_angle(double radius, double tolerance);

struct CurvePoint {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  // m
  double share = 0.0;                           // of the length of the curve
  bool is_inside = false;  // neither the end nor a place where tangent or curvature jumps
};

/// Points behind the start; the last is the end. None of a curve without length.
/// @param tolerance  m, > 0
std::vector<CurvePoint> points_of(const SplineCurve& curve, double tolerance);

/// Direction and curvature (1/m) where a curve begins or ends.
struct CurveEnd {
  Eigen::Vector3d tangent = Eigen::Vector3d::Zero();
  Eigen::Vector3d curvature = Eigen::Vector3d::Zero();
};

/// Nothing for a helix, a spiral, and where rotary axes turn meanwhile.
/// @param step      of the joints, linear ones in metres
/// @param fraction  0 or 1
std::optional<CurveEnd> end_of_circle(const ArcSweep& arc, const Joints& step, double fraction);

/// True if the joint of two curves is a point like any other: the direction turns by less than
/// 1e-3 rad there, and the curvature changes by less than a twentieth.
bool goes_on(const CurveEnd& end, const CurveEnd& begin);

/// True if an arc continues another one, on the same circle and in the same direction.
/// @param step  of the joints on the next
bool is_same_circle(const ArcSweep& one, const ArcSweep& next, const Joints& step);

}  // namespace servomill::controllers
