/// A matrix whose eigenvalues are known, for tests of factorisations.
#pragma once

#include <Eigen/Core>

namespace servomill::sim::numerics {

/// Second difference: 2 on the diagonal, -1 next to it; eigenvalues 2 - 2 cos(k pi / (n + 1)),
/// k = 1 ... n.
inline Eigen::MatrixXd second_difference(int n) {
  Eigen::MatrixXd A = 2.0 * Eigen::MatrixXd::Identity(n, n);
  A.diagonal(1).setConstant(-1.0);
  A.diagonal(-1).setConstant(-1.0);
  return A;
}

}  // namespace servomill::sim::numerics
