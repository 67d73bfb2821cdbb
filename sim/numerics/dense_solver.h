/// Factorisations of dense matrices, for fits and adjustments. Each takes g++ seconds for every
/// size of matrix that asks for it: this is the only source that has them, once and for all sizes.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace servomill::sim::numerics {

/// x of A x = b, by LDL^T. @pre A is symmetric and positive definite
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// The same for every column of B.
Eigen::MatrixXd solve_symmetric_columns(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// Inverse of A, by Cholesky's L L^T. @pre A is symmetric and positive definite
Eigen::MatrixXd inverse_of_definite(const Eigen::MatrixXd& A);

/// L of A = L L^T. @pre A is symmetric and positive definite
Eigen::MatrixXd cholesky_factor(const Eigen::MatrixXd& A);

/// x of least |A x - b|, by QR with column pivoting. @pre A has full column rank
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// R of A = Q R, min(rows, columns) x columns.
Eigen::MatrixXd triangular_factor(const Eigen::MatrixXd& A);

/// Pseudo-inverse of A, by a complete orthogonal decomposition.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& A);

/// Shortest rotation that turns `from` into the direction of `to`. @pre neither is zero
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace servomill::sim::numerics
