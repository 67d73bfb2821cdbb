/// Derivatives of deviations of the tool by the unknown errors.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "sim/calibration/adjustment.h"

namespace servomill::sim::calibration {

/// Effects of location errors, functions and grids at poses, to first order about the ideal
/// machine.
///
/// Unknowns are followed by the lines of functions (FunctionBasis): columns of a row are `size()`
/// unknowns and behind them `lines()` lines, and the row of the unknowns alone is
///     row(u) - line(u)' P.
class ErrorEffects {
 public:
  ErrorEffects(const plant::MachineChain& chain, const Unknowns& unknowns);

  int size() const { return size_; }
  int lines() const { return static_cast<int>(P_.rows()); }
  const Eigen::MatrixXd& projection() const { return P_; }  ///< P, lines x unknowns

  /// Calls add(column, effect) for each effect of a pose that is not 0; columns may repeat.
  void visit(const Pose& pose, const std::function<void(int, double)>& add) const;

  int joint_of(std::size_t f) const;  ///< of a function
  /// Shift of the tip (3, in W) for a value of one of a function.
  Eigen::Vector3d unit_shift(std::size_t f, const Joints& Q, const Eigen::Vector3d& p_ST) const;

  /// Effects of the unknowns at a pose, set-ups included as 0.
  Eigen::RowVectorXd row(const Pose& pose) const;

 private:
  void visit_grids(const Pose& pose, const std::function<void(int, double)>& add) const;

  const plant::MachineChain& chain_;
  const Unknowns& unknowns_;
  int size_;
  Eigen::MatrixXd P_;
  std::vector<int> line_of_;      // first line of each function
  std::vector<Deviations> unit_;  // of each location error, function and grid
};

/// Covariance of the deviation of the tip (3x3, m^2, in W) that is left once the adjusted errors
/// are corrected, at joints Q with a tool whose tip lies at p_ST.
Eigen::Matrix3d tip_covariance(const ErrorEffects& effects, const Adjustment& adjustment,
                               const Joints& Q, const Eigen::Vector3d& p_ST);

}  // namespace servomill::sim::calibration
