#include "sim/calibration/grid_basis.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>

namespace servomill::sim::calibration::grid_basis_test {
namespace {

GridForm form() {
  GridForm out;
  out.axes = {Axis::X, Axis::Z};
  out.knots = {{{0.1, 0.25, 0.6, 0.9}, {-0.3, -0.1, 0.0}}};
  out.travel = {{{0.0, 0.9}, {-0.4, 0.2}}};
  return out;
}

// Means over the knots, by the middle of many strips.
TEST(GridBasis, HasNoMeanOverEitherAxis) {
  const GridBasis basis(form());
  ASSERT_EQ(basis.size(), 3 * 2);
  constexpr int n = 20000;
  for (const double at : {-0.25, -0.05}) {
    Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(basis.size());
    for (int i = 0; i < n; ++i) mean += basis.row(0.1 + 0.8 * (i + 0.5) / n, at) / n;
    EXPECT_LE(mean.cwiseAbs().maxCoeff(), 1e-8) << at;
  }
  for (const double at : {0.15, 0.7}) {
    Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(basis.size());
    for (int i = 0; i < n; ++i) mean += basis.row(at, -0.3 + 0.3 * (i + 0.5) / n) / n;
    EXPECT_LE(mean.cwiseAbs().maxCoeff(), 1e-8) << at;
  }
}

// Every bilinear error without means is one of them: as many as are independent.
TEST(GridBasis, HoldsEveryGridWithoutMeans) {
  const GridForm form = grid_basis_test::form();
  const GridBasis basis(form);
  Eigen::MatrixXd rows(12, basis.size());
  int row = 0;
  for (const double s : form.knots[0]) {
    for (const double t : form.knots[1]) rows.row(row++) = basis.row(s, t);
  }
  EXPECT_EQ(Eigen::FullPivLU<Eigen::MatrixXd>(rows).rank(), (4 - 1) * (3 - 1));
}

TEST(GridBasis, IsTheGridOfAMachineFromEndToEndOfTheTravel) {
  const GridBasis basis(form());
  Eigen::VectorXd c(basis.size());
  c << 3e-6, -2e-6, 5e-6, 1e-6, -4e-6, 2e-6;
  const plant::GridFunction grid(basis.points(c));
  EXPECT_EQ(grid.axes(), (std::vector{Axis::X, Axis::Z}));
  EXPECT_EQ(grid.points().at[0], (std::vector{0.0, 0.1, 0.25, 0.6, 0.9}));
  EXPECT_EQ(grid.points().at[1], (std::vector{-0.4, -0.3, -0.1, 0.0, 0.2}));
  for (const double s : {0.0, 0.05, 0.1, 0.17, 0.5, 0.9}) {
    for (const double t : {-0.4, -0.3, -0.22, -0.05, 0.0, 0.2}) {
      const std::array<double, 2> at = {s, t};
      EXPECT_NEAR(grid.value(at), basis.row(s, t).dot(c), 1e-20) << s << ' ' << t;
    }
  }
}

}  // namespace
}  // namespace servomill::sim::calibration::grid_basis_test
