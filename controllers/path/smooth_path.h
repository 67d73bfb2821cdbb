/// A polyline in joint space, its corners rounded so that the third derivative is bounded.
///
/// The polyline over its length s is a straight line plus a ramp dd_i (s - s_i)_+ at each vertex,
/// dd_i the change of direction. Each ramp is convolved with the triangle of half-width w_i,
///
///            K(x)                          w - |x|
///        1/w  /\                   K(x) =  -------      |x| < w
///            /  \                            w^2
///        ___/    \___ x
///          -w    w                                                                          (1)
///
/// and since ramps superpose, windows of neighbouring vertices may overlap:
///
///     q(s) = polyline(s) + sum_i dd_i e_i(s - s_i),   e_i(x) = (w_i - |x|)^3 / (6 w_i^2)    (2)
///     q''  = sum_i dd_i K_i,                          q''' piecewise constant.
///
/// Between knots (s_i - w_i, s_i, s_i + w_i) q is a cubic. A lone corner is missed by |dd| w/6, a
/// chain of chords of curvature k by k w^2/12. The windows are as wide as the tolerance allows, end
/// within the path, and |w_i+1 - w_i| <= s_i+1 - s_i, which keeps |q'| <= 1.                   (3)
#pragma once

#include <cstddef>
#include <vector>

#include "controllers/path/polyline.h"
#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

/// q(x) = c0 + c1 x + c2 x^2/2 + c3 x^3/6 for x = s - `s` from 0 to the next piece.
struct CubicPiece {
  double s = 0.0;
  Joints c0, c1, c2, c3;
  std::size_t segment = 0;  // chord of the polyline to which it belongs
};

/// Place on a path and derivatives by s.
struct PathState {
  Joints q = Joints::Zero(), d1 = Joints::Zero(), d2 = Joints::Zero();  // m, 1, 1/m
};

/// A part of the smoothed polyline that other pieces take.
struct Stretch {
  double from = 0.0, to = 0.0;      // m
  std::size_t first = 0, last = 0;  // pieces
};

struct SmoothPath {
  std::vector<CubicPiece> pieces;
  std::vector<double> s;  // of each vertex
  double length() const { return s.back(); }
  double end_of(std::size_t piece) const {
    return piece + 1 < pieces.size() ? pieces[piece + 1].s : length();
  }
};

/// Runs of many short chords, where windows cover several vertices, are then replaced by splines of
/// less third derivative (fair_spline.h), and the inside of splines by their interpolation
/// (exact_curves.h).
///
/// @param vertices  at least two, neighbours apart
/// @param jerk      limit of each joint (scaled like the path; > 0 for joints that move)
/// Law: begins and ends exactly in the first and last vertex, with zero curvature; the distance to
/// the polyline (of arcs: to the circle) is within the tolerance of the chord.
SmoothPath smooth(Polyline vertices, const Joints& jerk);

}  // namespace servomill::controllers
