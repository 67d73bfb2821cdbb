#include "sim/calibration/optimal_design.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace servomill::sim::calibration::optimal_design_test {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;

// Readings of a polynomial of degree 3 at places of [-1, 1]; all values on a grid count.
RowVectorXd powers(double u) { return (RowVectorXd(4) << 1.0, u, u * u, u * u * u).finished(); }

DesignProblem cubic(int places) {
  std::vector<Candidate> candidates;
  std::vector<MatrixXd> quantities;
  for (int i = 0; i < places; ++i) {
    const RowVectorXd f = powers(2.0 * i / (places - 1) - 1.0);
    candidates.push_back({.information = f.transpose() * f, .time = 1.0});
    quantities.emplace_back(f);
  }
  return DesignProblem(candidates, MatrixXd::Zero(4, 4), quantities);
}

// Kiefer and Wolfowitz: the largest variance of the best design is the number of unknowns over that
// of readings; its support is -1, 1 and +-1/sqrt(5), each with a quarter.
TEST(OptimalDesign, ReachesTheBoundOfKieferAndWolfowitzForTheCubic) {
  constexpr int kPlaces = 401;
  const Design design = cubic(kPlaces).relaxed(40.0);
  EXPECT_NEAR(design.worst, 4.0 / 40.0, 0.02 * 4.0 / 40.0);
  EXPECT_GE(design.bound, 0.98 * 4.0 / 40.0);
  EXPECT_LE(design.bound, 4.0 / 40.0 * (1.0 + 1e-9));
  double near = 0.0;
  for (int i = 0; i < kPlaces; ++i) {
    const double u = 2.0 * i / (kPlaces - 1) - 1.0;
    for (const double support : {-1.0, -1.0 / std::sqrt(5.0), 1.0 / std::sqrt(5.0), 1.0}) {
      if (std::abs(u - support) < 0.05) near += design.counts[std::size_t(i)];
    }
  }
  EXPECT_GT(near, 0.95 * 40.0);
}

TEST(OptimalDesign, WholeCountsLoseLittle) {
  const DesignProblem problem = cubic(41);
  const Design relaxed = problem.relaxed(20.0);
  const Design whole = problem.whole(relaxed, 20.0);
  EXPECT_NEAR(std::accumulate(whole.counts.begin(), whole.counts.end(), 0.0), 20.0, 1e-12);
  for (const double count : whole.counts) EXPECT_EQ(count, std::floor(count));
  EXPECT_GT(whole.efficiency(), 0.93);
  // equal spacing of as many readings does much worse
  std::vector<double> equal(41, 0.0);
  for (int i = 0; i < 20; ++i) equal[std::size_t(std::lround(i * 40.0 / 19.0))] += 1.0;
  const std::vector<double> v = problem.variances(equal);
  EXPECT_GT(*std::max_element(v.begin(), v.end()), 1.3 * whole.worst);
}

TEST(OptimalDesign, SpendsItsTimeWhereItGainsMost) {
  // two unknowns; a reading of the second costs four times as much: for equal variances of both,
  // counts a and b with a + 4 b = T, a = b
  MatrixXd one = MatrixXd::Zero(2, 2), other = one;
  one(0, 0) = other(1, 1) = 1.0;
  const DesignProblem problem({{one, 1.0}, {other, 4.0}}, MatrixXd::Zero(2, 2),
                              {RowVectorXd::Unit(2, 0), RowVectorXd::Unit(2, 1)});
  const Design design = problem.relaxed(100.0);
  EXPECT_NEAR(design.counts[0], 20.0, 0.3);
  EXPECT_NEAR(design.counts[1], 20.0, 0.3);
  EXPECT_NEAR(design.efficiency(), 1.0, 0.02);
  EXPECT_LE(design.efficiency(), 1.0 + 1e-12);
}

TEST(OptimalDesign, KnowsWhatIsKnownBefore) {
  // the first unknown is known well enough: all time goes to the second
  MatrixXd one = MatrixXd::Zero(2, 2), other = one, known = one;
  one(0, 0) = other(1, 1) = 1.0;
  known(0, 0) = 1e6;
  known(1, 1) = 1e-6;
  const DesignProblem problem({{one, 1.0}, {other, 1.0}}, known,
                              {RowVectorXd::Unit(2, 0), RowVectorXd::Unit(2, 1)});
  const Design design = problem.relaxed(10.0);
  EXPECT_NEAR(design.counts[1], 10.0, 0.1);
  EXPECT_GT(design.efficiency(), 0.97);
}

}  // namespace
}  // namespace servomill::sim::calibration::optimal_design_test
