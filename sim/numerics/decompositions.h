/// Eigenvalues and singular values of dense matrices. Like the factorisations of dense_solver.h
/// these take g++ seconds: this is the only source that has them.
#pragma once

#include <Eigen/Core>

namespace servomill::sim::numerics {

/// A = vectors diag(values) vectors^T; values ascend, vectors are columns of length 1.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A);

/// Smallest eigenvalue of a symmetric matrix.
double least_eigenvalue(const Eigen::MatrixXd& A);

/// Eigenvalues of any square matrix, in no order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A);

/// A = U diag(s) V^T of a square matrix; s descends.
struct SingularValues {
  Eigen::MatrixXd U, V;
  Eigen::VectorXd s;

  /// Number of singular values above `threshold` times the largest.
  Eigen::Index rank(double threshold) const;
  /// x of least squares and least length, from the `rank` largest.
  Eigen::VectorXd solve(const Eigen::VectorXd& b, Eigen::Index rank) const;
};
SingularValues singular_values(const Eigen::MatrixXd& A);

}  // namespace servomill::sim::numerics
