/// A rational B-spline (NURBS) in space, by its arc length.
///
/// With degree d = order - 1, control points P_i and weights w_i it is
///
///     C(u) = sum_i w_i N_i,d(u) P_i / sum_i w_i N_i,d(u)                                      (1)
///
/// on knots that begin with `order` times 0, end with `order` times the last and are 1 apart in
/// between: the curve begins in the first control point and ends in the last. As many points as the
/// order make a Bezier curve. Between knots C is a rational Bezier curve, which is how it is held.
///
/// The arc length is integrated by Gauss' rule on cells that are halved until halving changes the
/// length of a cell by less than 1e-13 m; s is solved for u to rounding.
///
/// Source: Piegl, Tiller, "The NURBS Book", 1997, equation 4.1; de Boor's blossom for the Bezier
/// points. Knots: LinuxCNC 2.9, G-code reference, G5.2 G5.3.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

namespace servomill {

class SplineCurve {
 public:
  /// Place on the curve.
  struct State {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();          // m
    Eigen::Vector3d tangent = Eigen::Vector3d::Zero();    // 1
    Eigen::Vector3d curvature = Eigen::Vector3d::Zero();  // 1/m, derivative of `tangent` by s
  };

  /// @param points   (m) at least `order`
  /// @param weights  > 0, one for each point
  /// @pre order >= 3
  SplineCurve(int order, std::vector<Eigen::Vector3d> points, std::vector<double> weights);

  int order() const { return order_; }
  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  const std::vector<double>& weights() const { return weights_; }
  double length() const { return length_; }  ///< m

  /// @param s  m, 0 to length()
  Eigen::Vector3d point(double s) const;
  /// At a derivative of 0 (control points that coincide) tangent and curvature are those next to
  /// it.
  State state(double s) const;

  /// Arc lengths where the tangent or the curvature jumps (by more than a twentieth), rising: knots
  /// of order 3, control points that coincide, cusps.
  std::vector<double> breaks() const;
  /// Arc lengths, rising, close together where the curve bends: what lies between them does not
  /// differ much from them.
  std::vector<double> samples() const;

  /// Arc length (m) of the point closest to p (m).
  double closest(const Eigen::Vector3d& p) const;
  /// Least and largest X, Y and Z (m).
  std::pair<Eigen::Vector3d, Eigen::Vector3d> extent() const;

 private:
  using Bezier = std::vector<Eigen::Vector4d>;  // w x, w y, w z, w
  struct Derivatives {
    Eigen::Vector3d p, d1, d2;  // by t
  };
  struct Place {
    std::size_t bezier = 0;
    double t = 0.0;  // 0 to 1 in it
  };
  struct Cell {
    std::size_t bezier = 0;
    double from = 0.0, to = 0.0;  // t
    double s = 0.0;               // m, where it begins
  };

  Eigen::Vector4d blossom(std::size_t span, const std::vector<double>& u) const;
  double knot(std::size_t i) const;
  void take_beziers();
  void measure();
  void measure_part(std::size_t bezier, double from, double to, double whole, int depth);
  double part_length(std::size_t bezier, double from, double to) const;
  Derivatives derivatives(const Place& at) const;
  State state_at(const Place& at, double side) const;
  std::size_t cell_of(double s) const;
  Place closest_in(std::size_t interval, const Eigen::Vector3d& p) const;
  Place place(double s) const;

  int order_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<double> weights_;
  std::vector<Bezier> beziers_;
  std::vector<Cell> cells_;
  double length_ = 0.0;
};

/// The curve of a move: in machine coordinates, and its control points as they were programmed.
struct Spline {
  SplineCurve curve;
  std::vector<Eigen::Vector3d> points;  // m, in work coordinates; weights are those of the curve
};

/// The same curve in work coordinates.
inline SplineCurve curve_in_work(const Spline& spline) {
  return {spline.curve.order(), spline.points, spline.curve.weights()};
}

}  // namespace servomill
