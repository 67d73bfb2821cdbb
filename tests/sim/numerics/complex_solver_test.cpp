#include "sim/numerics/complex_solver.h"

#include <gtest/gtest.h>

#include <complex>

namespace servomill::sim::numerics::complex_solver_test {
namespace {

using Complex = std::complex<double>;
constexpr Complex j(0.0, 1.0);

// (1 + j) x + y = 2 and x - j y = -j: x = 1, y = 1 - j.
TEST(ComplexSolve, FindsTwoUnknownsByHand) {
  Eigen::MatrixXcd A(2, 2);
  A << 1.0 + j, 1.0, 1.0, -j;
  const Eigen::VectorXcd x = complex_solve(A, Eigen::Vector2cd(2.0, -j));
  EXPECT_LT(std::abs(x[0] - 1.0), 1e-15);
  EXPECT_LT(std::abs(x[1] - (1.0 - j)), 1e-15);
}

TEST(ComplexLeastSquares, OfOneUnknownIsTheProjectionAndItsWeightsTheConjugates) {
  Eigen::MatrixXcd A(3, 1);
  A << 1.0, j, 1.0 + j;  // |A|^2 = 4
  const Eigen::Vector3cd b(2.0, 1.0, -j);
  const ComplexLeastSquares fit = complex_least_squares(A, b);
  const Complex by_hand = (2.0 - j + (1.0 - j) * (-j)) / 4.0;
  EXPECT_LT(std::abs(fit.x[0] - by_hand), 1e-15);
  EXPECT_LT((fit.weights - Eigen::RowVector3cd(1.0, -j, 1.0 - j) / 4.0).norm(), 1e-15);
}

TEST(ComplexLeastSquares, GivesTheShortestSolutionWhereColumnsDepend) {
  Eigen::MatrixXcd A(2, 2);
  A << 1.0, j, 2.0, 2.0 * j;  // (1, 2)^T (1, j)
  const ComplexLeastSquares fit = complex_least_squares(A, Eigen::Vector2cd(1.0, 2.0));
  EXPECT_LT(std::abs(fit.x[0] - 0.5), 1e-15);  // x + j y = 1; the shortest is (1, -j) / 2
  EXPECT_LT(std::abs(fit.x[1] + 0.5 * j), 1e-15);
}

}  // namespace
}  // namespace servomill::sim::numerics::complex_solver_test
