/// A cubic spline through the tolerance of a polyline of many short chords.
///
/// Fairing: among all C2 cubic splines on given knots, with given place, direction and curvature at
/// both ends, the one with the least
///
///     sum_i  mu_i l_i |q(s_i) - u_i|^2  +  integral  (kappa w)^6 |q'''|^2 ds                 (1)
///
/// u_i the vertices, l_i the length of polyline that belongs to each, w the half-width of the
/// smoothing window there (smooth_path.h). Knots lie about half of w apart, so that there are fewer
/// of them than of chords. mu and kappa begin alike everywhere. Then some rounds solve (1), raise
/// mu where a vertex is missed by more than its tolerance, and the weight of q''' where it is too
/// large for the programmed speed; the others only raise mu, until the tolerance is kept
/// everywhere.
///
/// On a polyline of random direction no filter has a smaller q''' at the same
/// deviation than the first solution; it bends curves much longer than w by (w/L)^6, the window by
/// (w/L)^2.
///
/// Source of (1): Reinsch, "Smoothing by spline functions", Numerische Mathematik 10, 1967, there
/// with the second derivative.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "controllers/path/smooth_path.h"

namespace servomill::controllers {

class FairSpline {
 public:
  struct State {
    double s = 0.0;     // m
    Joints q, d1, d2;   // m, 1, 1/m
    std::size_t chord;  // that holds s
  };

  /// @param v, s, w  vertices of the polyline, their arc lengths and windows; of all chords
  /// @param jerk     limit of each joint, scaled like the path
  /// @return whether a spline within the tolerance of every chord was found; `pieces` then is it
  bool fit(const Polyline& v, std::span<const double> s, std::span<const double> w,
           const Joints& jerk, const State& begin, const State& end);

  const std::vector<CubicPiece>& pieces() const { return pieces_; }
  /// State at the beginning of a piece.
  State state_at(std::size_t piece) const;

 private:
  using Row = Eigen::Matrix<double, 1, 4>;
  struct Interval {            // between two knots
    Eigen::Matrix4d Q;         // coefficients of four B-splines -> q, q', q'', q''' at its begin
    std::array<double, 10> G;  // sum l_i B_i B_i^T, upper triangle by rows
    std::array<double, 10> F;  // the same of (kappa w)^6 q'''
    Eigen::Matrix<double, 4, kJoints> R;  // sum l_i B_i u_i^T
    double mu = 1.0;
    double cube = 0.0;                // m^3/s^3, of the least speed programmed there
    double bend = 0.0;                // largest |q'''| of a joint, of what it can do at that speed
    double worst = 0.0;               // largest square of deviation / tolerance
    std::size_t first = 0, last = 0;  // vertices first..last-1 lie in it
  };
  struct Point {  // a vertex
    std::array<double, 4> B;
  };

  void lay_knots();
  void form_intervals();
  void gather();
  void set_ends();
  void solve();
  bool deviations();
  void raise_weights();
  void spread_bends();
  void write();
  bool is_within_tolerance();

  const Polyline* v_ = nullptr;
  std::span<const double> s_, w_;
  State begin_, end_;
  Joints jerk_;
  std::size_t N_ = 0;            // intervals
  std::vector<double> t_, w_t_;  // knots, three more on either side; window at each interval
  std::vector<Interval> intervals_;
  std::vector<Point> points_;
  std::vector<Joints> c_;  // N + 3 coefficients
  std::vector<std::array<double, 4>> band_;
  std::vector<CubicPiece> pieces_;
};

}  // namespace servomill::controllers
