/// Systems of equations with complex numbers, compiled once like those of dense_solver.h.
#pragma once

#include <Eigen/Core>

namespace servomill::sim::numerics {

/// x of A x = b, by LU decomposition with partial pivoting. @pre A is regular
Eigen::VectorXcd complex_solve(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& b);

struct ComplexLeastSquares {
  Eigen::VectorXcd x;           // shortest of those with least |A x - b|
  Eigen::RowVectorXcd weights;  // of b in x[0]: first row of the pseudo-inverse of A
};

/// By a complete orthogonal decomposition: A may lack rank.
ComplexLeastSquares complex_least_squares(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& b);

}  // namespace servomill::sim::numerics
