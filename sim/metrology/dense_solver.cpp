#include "sim/metrology/dense_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cassert>

namespace servomill::sim::metrology {

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.ldlt().solve(b);
}

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
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

}  // namespace servomill::sim::metrology
