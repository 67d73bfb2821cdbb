#include "sim/identification/uncertainty.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>

namespace servomill::sim::identification::uncertainty_test {
namespace {

constexpr Eigen::Index kSamples = 2000;

Eigen::MatrixXd columns() {
  Eigen::MatrixXd X(kSamples, 3);
  for (Eigen::Index n = 0; n < kSamples; ++n) {
    const double t = static_cast<double>(n) / kSamples;
    X.row(n) << 1.0, t, std::sin(20.0 * t);
  }
  return X;
}

Mask all_of(Eigen::Index count) { return {std::vector<char>(static_cast<std::size_t>(count), 1)}; }

Eigen::VectorXd coloured_noise(unsigned seed) {
  boost::random::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  Eigen::VectorXd e(kSamples);
  double last = normal(generator) / std::sqrt(1.0 - 0.95 * 0.95);
  for (Eigen::Index n = 0; n < kSamples; ++n) e[n] = last = 0.95 * last + normal(generator);
  return e;
}

TEST(Uncertainty, OfWhiteResidualsIsThatOfCountedSamples) {
  boost::random::mt19937_64 generator(1);
  boost::random::normal_distribution<double> normal;
  Eigen::VectorXd e(kSamples);
  for (Eigen::Index n = 0; n < kSamples; ++n) e[n] = normal(generator);
  const Eigen::MatrixXd X = columns();
  e -= X * X.colPivHouseholderQr().solve(e);
  const Uncertainty u = uncertainty_of(X, e, all_of(kSamples));
  for (const std::size_t p : {0u, 1u, 2u}) EXPECT_NEAR(u.standard(p) / u.counted[p], 1.0, 0.25);
}

TEST(Uncertainty, IntervalsOfColouredNoiseHoldTheTruthAsOftenAsTheyClaim) {
  const Eigen::MatrixXd X = columns();
  const auto qr = X.colPivHouseholderQr();
  int inside = 0, counted = 0, all = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    Eigen::VectorXd e = coloured_noise(seed);
    const Eigen::VectorXd found = qr.solve(e);  // the truth is 0
    e -= X * found;
    const Uncertainty u = uncertainty_of(X, e, all_of(kSamples));
    for (const std::size_t p : {0u, 1u, 2u}) {
      const double miss = std::abs(found[static_cast<Eigen::Index>(p)]);
      inside += miss <= u.half_width(p) ? 1 : 0;
      counted += miss <= 2.0 * u.counted[p] ? 1 : 0;
      ++all;
    }
  }
  EXPECT_NEAR(static_cast<double>(inside) / all, 0.95, 0.03);
  EXPECT_LT(static_cast<double>(counted) / all, 0.5) << "counting samples claims far too much";
}

TEST(Uncertainty, ColumnsThatAreAlikeAreNamedNotGuessed) {
  Eigen::MatrixXd X(kSamples, 4);
  X.leftCols(3) = columns();
  X.col(3) = 2.0 * X.col(1) - X.col(0);
  const Uncertainty u = uncertainty_of(X, coloured_noise(3), all_of(kSamples));
  ASSERT_EQ(u.unidentifiable.size(), 1u);
  EXPECT_EQ(u.unidentifiable[0].parameters, (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_FALSE(u.identifiable[0] || u.identifiable[1] || u.identifiable[3]);
  EXPECT_TRUE(u.identifiable[2]);
  EXPECT_EQ(u.standard(1), 0.0) << "no number where there is none";
  EXPECT_GT(u.standard(2), 0.0);
}

TEST(Uncertainty, AColumnOfZerosIsUnidentifiable) {
  Eigen::MatrixXd X(kSamples, 4);
  X.leftCols(3) = columns();
  X.col(3).setZero();
  const Uncertainty u = uncertainty_of(X, coloured_noise(3), all_of(kSamples));
  EXPECT_FALSE(u.identifiable[3]);
  EXPECT_TRUE(u.identifiable[0] && u.identifiable[1] && u.identifiable[2]);
}

TEST(Uncertainty, StudentsQuantilesAreThoseOfTables) {
  EXPECT_NEAR(student_95(5.0), 2.571, 1e-3);
  EXPECT_NEAR(student_95(30.0), 2.042, 1e-3);
  EXPECT_NEAR(student_95(1e6), 1.960, 1e-3);
}

}  // namespace
}  // namespace servomill::sim::identification::uncertainty_test
