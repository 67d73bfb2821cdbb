#include "strategies/optimal_points.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <functional>
#include <limits>

namespace servomill::strategies::optimal_points_test {
namespace {

using Eigen::Vector3d;

struct Curve {
  std::vector<double> x;
  std::vector<Vector3d> value;
};

Curve sampled(double from, double to, std::size_t n, const std::function<Vector3d(double)>& f) {
  Curve out;
  for (std::size_t i = 0; i < n; ++i) {
    out.x.push_back(from + (to - from) * static_cast<double>(i) / static_cast<double>(n - 1));
    out.value.push_back(f(out.x.back()));
  }
  return out;
}

Curve random_curve(std::size_t n, unsigned seed) {
  boost::random::mt19937 generator(seed);
  boost::random::uniform_real_distribution<double> value(-1.0, 1.0), step(0.1, 1.0);
  Curve out;
  double x = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    out.x.push_back(x += step(generator));
    out.value.emplace_back(value(generator), value(generator), 0.0);
  }
  return out;
}

// Smallest largest deviation among all ways to keep the ends and at most `most` points.
double by_trying_all(const Curve& curve, std::size_t most) {
  const std::size_t n = curve.x.size();
  double least = std::numeric_limits<double>::infinity();
  for (unsigned mask = 0; mask < 1U << (n - 2); ++mask) {
    std::vector<std::size_t> points = {0};
    for (std::size_t i = 1; i + 1 < n; ++i) {
      if ((mask >> (i - 1) & 1U) != 0) points.push_back(i);
    }
    points.push_back(n - 1);
    if (points.size() > most) continue;
    least = std::min(least, largest_deviation(curve.x, curve.value, points));
  }
  return least;
}

TEST(OptimalPoints, AreThoseFoundByTryingAll) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Curve curve = random_curve(11, seed);
    for (const std::size_t most : {2, 3, 5, 8}) {
      const auto points = optimal_points(curve.x, curve.value, most);
      EXPECT_LE(points.size(), most);
      EXPECT_EQ(points.front(), 0U);
      EXPECT_EQ(points.back(), 10U);
      const double best = by_trying_all(curve, most);
      EXPECT_NEAR(largest_deviation(curve.x, curve.value, points), best, 1.1e-3 * best)
          << "seed " << seed << ", " << most << " points";
    }
  }
}

TEST(OptimalPoints, FewestPointsAreTheFewest) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Curve curve = random_curve(10, seed);
    for (const double tolerance : {0.1, 0.4, 0.8}) {
      const auto points = fewest_points(curve.x, curve.value, tolerance);
      EXPECT_LE(largest_deviation(curve.x, curve.value, points), tolerance * (1.0 + 1e-12));
      if (points.size() > 2) {
        EXPECT_GT(by_trying_all(curve, points.size() - 1), tolerance) << "seed " << seed;
      }
    }
  }
}

// The chord of a parabola over h deviates by h^2/8 times the curvature, wherever it is.
TEST(OptimalPoints, OfAParabolaAreEquidistant) {
  const Curve curve =
      sampled(0.0, 2.0, 801, [](double x) { return Vector3d(0.0, 3.0 * x * x, 0.0); });
  for (const std::size_t most : {5, 9, 17}) {
    const double h = 2.0 / static_cast<double>(most - 1);
    const auto points = optimal_points(curve.x, curve.value, most);
    EXPECT_NEAR(largest_deviation(curve.x, curve.value, points), h * h / 8.0 * 6.0, 1e-9);
    EXPECT_EQ(points[1], 800 / (most - 1));
  }
}

// Many points lie so that h^2 f'' is the same in all intervals: the deviation then is
// (integral of sqrt|f''|)^2 / (8 n^2).
TEST(OptimalPoints, LieDenserWhereTheCurvatureIsGreater) {
  const Curve curve =
      sampled(0.0, 4.0, 4001, [](double x) { return Vector3d(std::exp(x), 0.0, 0.0); });
  const double integral = 2.0 * (std::exp(2.0) - 1.0);
  constexpr double kIntervals = 40.0;
  const auto points = optimal_points(curve.x, curve.value, 41);
  const double deviation = largest_deviation(curve.x, curve.value, points);
  EXPECT_NEAR(deviation / (integral * integral / (8.0 * kIntervals * kIntervals)), 1.0, 0.03);
  const double equidistant = 0.1 * 0.1 / 8.0 * std::exp(4.0);  // at most
  EXPECT_LT(deviation, 0.25 * equidistant);
}

TEST(OptimalPoints, AllAreKeptWhereTheyAreNoMoreThanAllowed) {
  const Curve curve = random_curve(9, 3);
  EXPECT_EQ(optimal_points(curve.x, curve.value, 9).size(), 9U);
  EXPECT_EQ(optimal_points(curve.x, curve.value, 100).size(), 9U);
}

TEST(OptimalPoints, AStraightErrorNeedsItsEndsOnly) {
  const Curve curve = sampled(0.0, 1.0, 65, [](double x) { return Vector3d(x, -2.0 * x, 0.5); });
  EXPECT_EQ(optimal_points(curve.x, curve.value, 10), (std::vector<std::size_t>{0, 64}));
}

}  // namespace
}  // namespace servomill::strategies::optimal_points_test
