#include "sim/frequency/linear_algebra.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace servomill::sim::frequency {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A) { return A.eigenvalues(); }

Eigen::VectorXcd solve(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& b) {
  return A.partialPivLu().solve(b);
}

}  // namespace servomill::sim::frequency
