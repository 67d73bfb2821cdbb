/// Forms in which an adjustment looks for a component error, and what they span.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/geometry/error_function.h"

namespace servomill::sim::calibration {

/// A component error as a sum of what is asked for; over `lower` to `upper` (m or rad).
struct FunctionForm {
  double lower = 0.0, upper = 1.0;  // m or rad of travel, lower < upper
  int degree = 0;                   // of the polynomial; 0: none
  std::vector<double> knots;        // of the table, ascending, two at least; empty: none
  std::vector<double> periods;      // m or rad, of harmonics
  int reversal_degree = -1;         // of the width of the reversal; -1: none
  double reversal_distance = 1e-4;  // m or rad of travel that a reversal takes
};

/// Coefficient of one function of a basis at one place.
struct BasisValue {
  int index = 0;
  double value = 0.0;
};

/// Functions that satisfy the convention that separates component errors from location errors:
/// over lower to upper, uniformly weighted, their mean is 0, and that of the slope too where
/// `without_slope`. Each is a plain function (a Legendre polynomial, a hat of the table, a sine, a
/// cosine, a width of the reversal) less its line,
///
///     g_k(s) = f_k(s) - P_0k - P_1k u(s)        u: -1 at lower, 1 at upper
///
/// so that hats touch few numbers of a row: the line has columns of its own, and P is put in
/// afterwards. Widths of reversals have no line. What the lines take away is left out from the
/// beginning: the last hats of a table, as many as lines, and polynomials of degree 1 where there
/// is a table or no slope.
class FunctionBasis {
 public:
  FunctionBasis(FunctionForm form, bool without_slope);

  int size() const { return size_; }                                  ///< plain functions
  int lines() const { return static_cast<int>(projection_.rows()); }  ///< 1 or 2
  /// Numbers of the line of each function (lines x size).
  const Eigen::MatrixXd& projection() const { return projection_; }
  const FunctionForm& form() const { return form_; }

  /// Plain functions that are not 0 at s, and the lines, counted on behind them.
  /// @param direction  of travel: 1, -1; 0: the mean
  void evaluate(double s, double direction, std::vector<BasisValue>& out) const;

  /// Row of all functions g at s: 1 x size.
  Eigen::RowVectorXd row(double s, double direction) const;

  /// The error that coefficients of the functions g are.
  plant::ErrorFunction function(const Eigen::VectorXd& coefficients) const;

 private:
  double normalized(double s) const;
  void plain_values(double s, double direction, std::vector<BasisValue>& out) const;
  void project();

  FunctionForm form_;
  int least_degree_ = 1, hats_ = 0;
  int first_knot_ = 0, first_wave_ = 0, first_width_ = 0, size_ = 0;
  Eigen::MatrixXd projection_;
};

}  // namespace servomill::sim::calibration
