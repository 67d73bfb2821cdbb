#include "sim/numerics/dense_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cassert>

namespace servomill::sim::numerics {

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.ldlt().solve(b);
}

Eigen::MatrixXd solve_symmetric_columns(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return A.ldlt().solve(B);
}

Eigen::MatrixXd inverse_of_definite(const Eigen::MatrixXd& A) {
  return A.llt().solve(Eigen::MatrixXd::Identity(A.rows(), A.cols()));
}

Eigen::MatrixXd cholesky_factor(const Eigen::MatrixXd& A) { return A.llt().matrixL(); }

Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.colPivHouseholderQr().solve(b);
}

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

double least_eigenvalue(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

Eigen::MatrixXd triangular_factor(const Eigen::MatrixXd& A) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
  return qr.matrixQR().topRows(std::min(A.rows(), A.cols())).triangularView<Eigen::Upper>();
}

Eigen::Index SingularValues::rank(double threshold) const {
  return s.size() == 0 ? 0 : (s.array() > threshold * s[0]).count();
}

Eigen::VectorXd SingularValues::solve(const Eigen::VectorXd& b, Eigen::Index rank) const {
  const Eigen::VectorXd along = (U.leftCols(rank).transpose() * b).cwiseQuotient(s.head(rank));
  return V.leftCols(rank) * along;
}

SingularValues singular_values(const Eigen::MatrixXd& A) {
  assert(A.rows() == A.cols());
  const Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner> svd(
      A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.matrixV(), svd.singularValues()};
}

Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

}  // namespace servomill::sim::numerics
