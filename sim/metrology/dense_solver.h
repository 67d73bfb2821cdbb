/// Factorisations of small dense matrices, for fits. Each takes g++ seconds for every size of
/// matrix that asks for it: this is the only source that has them, once and for all sizes.
#pragma once

#include <Eigen/Core>

namespace servomill::sim::metrology {

/// x of A x = b, by LDL^T. @pre A is symmetric and positive definite
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// A = vectors diag(values) vectors^T; values ascend, vectors are columns of length 1.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A);

/// R of A = Q R, min(rows, columns) x columns.
Eigen::MatrixXd triangular_factor(const Eigen::MatrixXd& A);

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

}  // namespace servomill::sim::metrology
