/// Component errors over two axes, beside their mean over the other one.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "plant/geometry/grid_function.h"
#include "sim/calibration/function_basis.h"

namespace servomill::sim::calibration {

/// Knots of a grid over the axis of an error and another one.
struct GridForm {
  std::array<Axis, 2> axes{};                // that of the error, the other one
  std::array<std::vector<double>, 2> knots;  // m or rad, ascending, two at least
  /// Ends to which the grid of a machine has to reach (m, rad); those of the knots if within them.
  std::array<std::array<double, 2>, 2> travel{};
};

/// Products of hats over both axes, each less its mean over its knots (uniformly weighted):
///
///     e(s, t) = sum over i, j of c_ij g_i(s) g_j(t),   g_k = hat_k - mean of hat_k
///
/// Their mean over either axis is 0, so that the function of its own axis alone (FunctionBasis) is
/// the mean over the other one, and a function of the other axis alone is an error of that. The
/// last hat of each axis is left out: those before it hold it. Constant beyond the knots.
class GridBasis {
 public:
  explicit GridBasis(GridForm form);

  int size() const;  ///< products
  const GridForm& form() const { return form_; }

  /// All products at s of the own axis and t of the other one, in m or rad of them.
  void evaluate(double s, double t, std::vector<BasisValue>& out) const;
  /// Row of all products: 1 x size.
  Eigen::RowVectorXd row(double s, double t) const;

  /// The grid that coefficients of the products are, from end to end of the travel.
  plant::GridPoints points(const Eigen::VectorXd& coefficients) const;

 private:
  int along(std::size_t axis) const { return static_cast<int>(form_.knots[axis].size()) - 1; }
  Eigen::VectorXd centred_hats(std::size_t axis, double at) const;

  GridForm form_;
  std::array<Eigen::VectorXd, 2> mean_;  // of the hats
};

}  // namespace servomill::sim::calibration
