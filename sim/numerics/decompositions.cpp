#include "sim/numerics/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <cassert>

namespace servomill::sim::numerics {

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

double least_eigenvalue(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A) { return A.eigenvalues(); }

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

}  // namespace servomill::sim::numerics
