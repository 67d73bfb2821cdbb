#include "sim/numerics/dense_solver.h"

#include <gtest/gtest.h>

#include "tests/sim/numerics/second_difference.h"

namespace servomill::sim::numerics::dense_solver_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

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

TEST(TriangularFactor, IsTheCholeskyFactorOfTheNormalEquationsUpToSigns) {
  MatrixXd A(4, 2);
  A << 1, 0, 1, 1, 1, 2, 1, 3;
  const MatrixXd R = triangular_factor(A);
  ASSERT_EQ(R.rows(), 2);
  ASSERT_EQ(R.cols(), 2);
  EXPECT_EQ(R(1, 0), 0.0);
  EXPECT_LT((R.transpose() * R - A.transpose() * A).norm(), 1e-13);
}

TEST(PseudoInverse, OfARankOneMatrixIsItsTransposeOverTheSquareOfItsLength) {
  MatrixXd A(2, 3);
  A << 1, 2, 2, 2, 4, 4;  // (1, 2)^T (1, 2, 2), of length sqrt(5) 3
  EXPECT_LT((pseudo_inverse(A) - A.transpose() / 45.0).norm(), 1e-15);
}

}  // namespace
}  // namespace servomill::sim::numerics::dense_solver_test
