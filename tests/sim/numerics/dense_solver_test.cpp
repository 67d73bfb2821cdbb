#include "sim/numerics/dense_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace servomill::sim::numerics::dense_solver_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// 2 on the diagonal, -1 beside it: eigenvalues 2 - 2 cos(k pi / (n + 1)), k = 1 ... n.
MatrixXd second_difference(int n) {
  MatrixXd A = 2.0 * MatrixXd::Identity(n, n);
  A.diagonal(1).setConstant(-1.0);
  A.diagonal(-1).setConstant(-1.0);
  return A;
}

TEST(SolveSymmetric, GivesTheParabolaOfAConstantSecondDifference) {
  const int n = 7;
  const VectorXd x = solve_symmetric(second_difference(n), VectorXd::Ones(n));
  for (int i = 0; i < n; ++i) EXPECT_NEAR(x[i], 0.5 * (i + 1) * (n - i), 1e-13) << i;
}

TEST(InverseOfDefinite, TimesTheMatrixIsTheIdentityAndItsCholeskyFactorSquaredTheMatrix) {
  const MatrixXd A = second_difference(5);
  EXPECT_LT((inverse_of_definite(A) * A - MatrixXd::Identity(5, 5)).norm(), 1e-14);
  const MatrixXd L = cholesky_factor(A);
  EXPECT_LT((L * L.transpose() - A).norm(), 1e-14);
  EXPECT_EQ(L(0, 1), 0.0);
}

TEST(LeastSquares, FindsTheLineThroughFourPointsByHand) {
  MatrixXd A(4, 2);
  A << 1, 0, 1, 1, 1, 2, 1, 3;
  const VectorXd x = least_squares(A, VectorXd{{0.0, 1.0, 1.0, 4.0}});  // slope 6/5, at 0: -3/10
  EXPECT_NEAR(x[0], -0.3, 1e-14);
  EXPECT_NEAR(x[1], 1.2, 1e-14);
}

TEST(RotationBetween, TurnsOneDirectionIntoTheOtherEvenWhereTheyAreOpposite) {
  const Eigen::Vector3d a(1.0, 2.0, -2.0);
  for (const Eigen::Vector3d& b : {Eigen::Vector3d(0.0, 3.0, 4.0), Eigen::Vector3d(-a)}) {
    EXPECT_LT((rotation_between(a, b) * a.normalized() - b.normalized()).norm(), 1e-13);
  }
}

TEST(SymmetricEigen, HasTheEigenvaluesOfASecondDifferenceInAscendingOrder) {
  const int n = 6;
  const MatrixXd A = second_difference(n);
  const SymmetricEigen eigen = symmetric_eigen(A);
  EXPECT_NEAR(least_eigenvalue(A), eigen.values[0], 1e-15);
  for (int k = 0; k < n; ++k) {
    EXPECT_NEAR(eigen.values[k], 2.0 - 2.0 * std::cos((k + 1) * std::numbers::pi / (n + 1)), 1e-14);
    EXPECT_NEAR(eigen.vectors.col(k).norm(), 1.0, 1e-14);
    EXPECT_LT((A * eigen.vectors.col(k) - eigen.values[k] * eigen.vectors.col(k)).norm(), 1e-13);
  }
}

TEST(TriangularFactor, IsTheCholeskyFactorOfTheNormalEquationsUpToSigns) {
  MatrixXd A(4, 2);
  A << 1, 0, 1, 1, 1, 2, 1, 3;
  const MatrixXd R = triangular_factor(A);
  ASSERT_EQ(R.rows(), 2);
  ASSERT_EQ(R.cols(), 2);
  EXPECT_EQ(R(1, 0), 0.0);
  EXPECT_LT((R.transpose() * R - A.transpose() * A).norm(), 1e-13);
}

TEST(SingularValues, OfARankOneMatrix) {
  MatrixXd A(2, 2);
  A << 3, 6, 4, 8;  // (3, 4) (1, 2)^T
  const SingularValues svd = singular_values(A);
  EXPECT_NEAR(svd.s[0], 5.0 * std::sqrt(5.0), 1e-13);
  EXPECT_EQ(svd.rank(1e-10), 1);
  EXPECT_LT((svd.U * svd.s.asDiagonal() * svd.V.transpose() - A).norm(), 1e-13);
  // (3, 4) t is met by x + 2 y = t; the shortest is t / 5 (1, 2)
  const VectorXd x = svd.solve(Eigen::Vector2d(3.0, 4.0), 1);
  EXPECT_NEAR(x[0], 0.2, 1e-14);
  EXPECT_NEAR(x[1], 0.4, 1e-14);
}

TEST(SingularValues, OfARegularMatrixSolveIt) {
  const MatrixXd A = second_difference(5);
  const VectorXd x = VectorXd::LinSpaced(5, -1.0, 2.0);
  const SingularValues svd = singular_values(A);
  EXPECT_EQ(svd.rank(1e-10), 5);
  EXPECT_LT((svd.solve(A * x, 5) - x).norm(), 1e-13);
}

TEST(SingularValues, OfZeroHaveNoRank) {
  EXPECT_EQ(singular_values(MatrixXd::Zero(3, 3)).rank(1e-10), 0);
}

}  // namespace
}  // namespace servomill::sim::numerics::dense_solver_test
