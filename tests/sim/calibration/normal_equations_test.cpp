#include "sim/calibration/normal_equations.h"

#include <gtest/gtest.h>

#include <cmath>

namespace servomill::sim::calibration::normal_equations_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Unknowns 0, 1, 3 of their own; 2 = 2 x 0 - 1; 4 without effect. Sizes differ by 10^12.
MatrixXd effects() {
  MatrixXd J = MatrixXd::Zero(8, 5);
  for (int i = 0; i < 8; ++i) {
    J(i, 0) = 1.0 + i;
    J(i, 1) = 1.0 - 0.1 * i * i;
    J(i, 2) = 2.0 * J(i, 0) - J(i, 1);
    J(i, 3) = (i % 3) * 1e6;
  }
  J.col(0) *= 1e-6;
  return 1e9 * J;
}

TEST(NormalEquations, LeaveOutTheLaterOfDependentUnknownsAndSayWhatHoldsIt) {
  const MatrixXd J = effects();
  const NormalEquations equations(J.transpose() * J, 1e-6, VectorXd::Zero(5));
  EXPECT_EQ(equations.kept(), (std::vector<int>{0, 1, 3}));
  ASSERT_EQ(equations.left_out().size(), 2u);
  EXPECT_EQ(equations.left_out()[0].unknown, 2);
  ASSERT_EQ(equations.left_out()[0].parts.size(), 2u);
  EXPECT_EQ(equations.left_out()[0].parts[0].unknown, 0);
  EXPECT_NEAR(equations.left_out()[0].parts[0].factor, 2e6, 1.0);
  EXPECT_NEAR(equations.left_out()[0].parts[1].factor, -1.0, 1e-6);
  EXPECT_EQ(equations.left_out()[1].unknown, 4);
  EXPECT_TRUE(equations.left_out()[1].parts.empty());
}

TEST(NormalEquations, SolveForTheKeptUnknownsWhichHoldTheOthers) {
  const MatrixXd J = effects();
  VectorXd x(5);
  x << 1e5, -2.0, 3.0, 4e-6, 7.0;
  const NormalEquations equations(J.transpose() * J, 1e-6, VectorXd::Zero(5));
  const VectorXd solved = equations.solve(J.transpose() * (J * x));
  EXPECT_NEAR(solved[0], 1e5 + 3.0 * 2e6, 1e-3);
  EXPECT_NEAR(solved[1], -5.0, 1e-6);
  EXPECT_EQ(solved[2], 0.0);
  EXPECT_NEAR(solved[3], 4e-6, 1e-14);
  EXPECT_EQ(solved[4], 0.0);
}

TEST(NormalEquations, InverseIsThatOfTheKeptUnknowns) {
  const MatrixXd J = effects();
  const MatrixXd A = J.transpose() * J;
  const MatrixXd inverse = NormalEquations(A, 1e-6, VectorXd::Zero(5)).inverse();
  MatrixXd kept = MatrixXd::Zero(5, 5);
  for (const int i : {0, 1, 3}) kept(i, i) = 1.0;
  const VectorXd size = A.diagonal().cwiseSqrt().cwiseMax(1e-300);  // of an effect
  const MatrixXd product = inverse * kept * A * kept;
  const MatrixXd scaled = size.asDiagonal() * product * size.cwiseInverse().asDiagonal();
  EXPECT_NEAR((scaled - kept).cwiseAbs().maxCoeff(), 0.0, 1e-9);
  EXPECT_EQ(inverse.row(2).norm(), 0.0);
  EXPECT_EQ(inverse.col(4).norm(), 0.0);
}

TEST(NormalEquations, ExpectationsDrawToZeroButDecideNothing) {
  const MatrixXd J = effects();
  const MatrixXd A = J.transpose() * J;
  const VectorXd expected = (VectorXd(5) << 0.0, 3e18, 1e30, 0.0, 1.0).finished();
  const NormalEquations equations(A, 1e-6, expected);
  EXPECT_EQ(equations.kept(), (std::vector<int>{0, 1, 3}));
  const VectorXd b = A * (VectorXd(5) << 1e5, -2.0, 0.0, 4e-6, 0.0).finished();
  const VectorXd x = equations.solve(b);
  MatrixXd whole = A;
  whole.diagonal() += expected;
  VectorXd left = b - whole * x;
  for (const int i : {0, 1, 3}) EXPECT_NEAR(left[i] / b[i], 0.0, 1e-9);
  EXPECT_LT(std::abs(x[1]), 2.0);
}

}  // namespace
}  // namespace servomill::sim::calibration::normal_equations_test
