#include "sim/calibration/function_basis.h"

#include <gtest/gtest.h>

#include <cmath>

namespace servomill::sim::calibration::function_basis_test {
namespace {

FunctionForm everything() {
  FunctionForm form;
  form.lower = 0.1;
  form.upper = 0.7;
  form.degree = 4;
  form.knots = {0.1, 0.15, 0.3, 0.5, 0.7};
  form.periods = {0.05, 0.2};
  form.reversal_degree = 1;
  return form;
}

Eigen::VectorXd numbers(int n) {
  Eigen::VectorXd out(n);
  for (int i = 0; i < n; ++i) out[i] = 1e-6 * std::sin(1.0 + 7.0 * i);
  return out;
}

std::vector<FunctionForm> forms() {
  std::vector<FunctionForm> out(4, everything());
  out[1].knots.clear();
  out[2].degree = 0;
  out[3].degree = 0;
  out[3].periods.clear();
  out[3].reversal_degree = -1;
  return out;
}

TEST(FunctionBasis, HasNeitherMeanNorSlopeOverTheTravel) {
  for (const FunctionForm& form : forms()) {
    for (const bool without_slope : {false, true}) {
      const FunctionBasis basis(form, without_slope);
      const plant::ErrorFunction f = basis.function(numbers(basis.size()));
      const int n = 60'000;
      double mean = 0.0, slope = 0.0;
      for (int i = 0; i < n; ++i) {
        const double s = form.lower + (form.upper - form.lower) * (i + 0.5) / n;
        mean += f.value(s) / n;
        slope += f.value(s) * (s - 0.4) / n;
      }
      EXPECT_NEAR(mean, 0.0, 1e-14);
      if (without_slope) {
        EXPECT_NEAR(slope, 0.0, 1e-14);
      }
    }
  }
}

TEST(FunctionBasis, RowTimesCoefficientsIsTheErrorFunction) {
  for (const FunctionForm& form : forms()) {
    for (const bool without_slope : {false, true}) {
      const FunctionBasis basis(form, without_slope);
      const Eigen::VectorXd c = numbers(basis.size());
      for (const double direction : {-1.0, 0.0, 1.0}) {
        const auto f = plant::travelling(basis.function(c), direction);
        for (const double s : {0.1, 0.12, 0.3, 0.456, 0.7}) {
          EXPECT_NEAR(basis.row(s, direction) * c, f.value(s), 1e-18) << s;
        }
      }
    }
  }
}

TEST(FunctionBasis, PlainFunctionsAndLinesMakeTheRow) {
  const FunctionBasis basis(everything(), true);
  std::vector<BasisValue> values;
  basis.evaluate(0.37, 1.0, values);
  Eigen::RowVectorXd all = Eigen::RowVectorXd::Zero(basis.size() + basis.lines());
  for (const BasisValue& one : values) all[one.index] += one.value;
  const Eigen::RowVectorXd row =
      all.head(basis.size()) - all.tail(basis.lines()) * basis.projection();
  EXPECT_NEAR((row - basis.row(0.37, 1.0)).norm(), 0.0, 1e-15);
}

// Every table is one of the basis, but for its mean and its mean line.
TEST(FunctionBasis, SpansAllTablesButTheirMeanLine) {
  for (const bool without_slope : {false, true}) {
    FunctionForm form;
    form.lower = 0.0;
    form.upper = 1.0;
    form.knots = {0.0, 0.2, 0.5, 1.0};
    const FunctionBasis basis(form, without_slope);
    EXPECT_EQ(basis.size(), without_slope ? 2 : 3);
    const Eigen::Vector4d table(3.0, -1.0, 2.0, 5.0);
    Eigen::MatrixXd A(4, basis.size() + basis.lines());
    for (int i = 0; i < 4; ++i) {
      const double s = form.knots[static_cast<std::size_t>(i)];
      A.row(i).head(basis.size()) = basis.row(s, 0.0);
      A(i, basis.size()) = 1.0;
      if (without_slope) A(i, basis.size() + 1) = s;
    }
    const Eigen::VectorXd x = (A.transpose() * A).llt().solve(A.transpose() * table);
    EXPECT_NEAR((A * x - table).norm(), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace servomill::sim::calibration::function_basis_test
