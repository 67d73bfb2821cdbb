#include "sim/numerics/complex_solver.h"

#include <Eigen/LU>
#include <Eigen/QR>

namespace servomill::sim::numerics {

Eigen::VectorXcd complex_solve(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& b) {
  return A.partialPivLu().solve(b);
}

ComplexLeastSquares complex_least_squares(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& b) {
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXcd> solver(A);
  return {solver.solve(b), solver.pseudoInverse().row(0)};
}

}  // namespace servomill::sim::numerics
