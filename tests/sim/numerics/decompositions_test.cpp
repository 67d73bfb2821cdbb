#include "sim/numerics/decompositions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/sim/numerics/second_difference.h"

namespace servomill::sim::numerics::decompositions_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

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

// x^3 - 6 x^2 + 11 x - 6 = (x - 1) (x - 2) (x - 3); x^2 + 2 x + 5 has the roots -1 +- 2 i.
TEST(Eigenvalues, OfCompanionMatricesAreTheRootsOfTheirPolynomials) {
  MatrixXd cubic(3, 3);
  cubic << 0, 0, 6, 1, 0, -11, 0, 1, 6;
  VectorXd roots = eigenvalues(cubic).real();
  std::sort(roots.begin(), roots.end());
  EXPECT_LT((roots - Eigen::Vector3d(1.0, 2.0, 3.0)).norm(), 1e-12);
  MatrixXd square(2, 2);
  square << 0, -5, 1, -2;
  const Eigen::VectorXcd pair = eigenvalues(square);
  for (const std::complex<double> root : pair) {
    EXPECT_NEAR(root.real(), -1.0, 1e-14);
    EXPECT_NEAR(std::abs(root.imag()), 2.0, 1e-14);
  }
  EXPECT_NEAR((pair[0] + pair[1]).imag(), 0.0, 1e-15);
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
}  // namespace servomill::sim::numerics::decompositions_test
