#include "sim/metrology/circle_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "plant/vocabulary/units.h"

namespace servomill::sim::metrology::circle_fit_test {
namespace {

using Eigen::Vector2d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kR = 50.0 * mm;
constexpr double kRounding = 1e-15;   // m, of some operations on lengths of 0.1 m
constexpr double kZoneTol = 1e-14;    // m: the search ends at a gain of 1e-12 of zones of 10 um
const Vector2d kCentre(0.12, -0.34);  // m

// n points around kCentre at radius(theta), theta from 0 to one turn
std::vector<Vector2d> around(int n, const std::function<double(double)>& radius) {
  std::vector<Vector2d> points;
  for (int i = 0; i < n; ++i) {
    const double theta = kTurn * i / n;
    points.push_back(kCentre + radius(theta) * Vector2d(std::cos(theta), std::sin(theta)));
  }
  return points;
}

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double within(double low, double high) { return low + (high - low) * unit_(generator_); }
  // points in n equal sectors at random angles within, radius R +- spread
  std::vector<Vector2d> ring(int n, double spread) {
    std::vector<Vector2d> points;
    for (int i = 0; i < n; ++i) {
      const double theta = kTurn * (i + within(0.0, 1.0)) / n;
      points.push_back(kCentre +
                       (kR + within(-spread, spread)) * Vector2d(std::cos(theta), std::sin(theta)));
    }
    return points;
  }

 private:
  boost::random::mt19937 generator_;
  boost::random::uniform_real_distribution<double> unit_{0.0, 1.0};
};

TEST(LeastSquaresCircle, ReturnsTheCircleThatPointsLieOn) {
  Random random(1);
  for (int n : {3, 4, 7, 1000}) {
    const Circle circle = least_squares_circle(random.ring(n, 0.0));
    EXPECT_NEAR((circle.centre - kCentre).norm(), 0.0, 20 * kRounding) << n;
    EXPECT_NEAR(circle.radius, kR, 20 * kRounding) << n;
  }
}

// An arc of 20 deg, too: there the algebraic and the geometric circle differ most.
TEST(LeastSquaresCircle, MakesTheSumOfSquaredDistancesSmallest) {
  Random random(2);
  const auto sum = [](const std::vector<Vector2d>& points, const Circle& c) {
    double out = 0.0;
    for (const Vector2d& p : points) out += std::pow((p - c.centre).norm() - c.radius, 2);
    return out;
  };
  for (const double arc : {1.0, 20.0 / 360.0}) {
    std::vector<Vector2d> points;
    for (int i = 0; i < 200; ++i) {
      const double theta = kTurn * arc * i / 200, r = kR + random.within(-1.0, 1.0) * mm;
      points.push_back(r * Vector2d(std::cos(theta), std::sin(theta)));
    }
    const Circle best = least_squares_circle(points);
    const double least = sum(points, best);
    for (int i = 0; i < 50; ++i) {
      Circle other = best;
      other.centre += Vector2d(random.within(-1, 1), random.within(-1, 1)) * 1.0 * um;
      other.radius += random.within(-1, 1) * 1.0 * um;
      EXPECT_GT(sum(points, other), least) << arc;
    }
  }
}

// Harmonics other than the first leave the centre; the mean radius is that of the circle but for
// (b/R)^2, here 1e-8: for r = R + b cos n theta the distances are those about the centre.
TEST(LeastSquaresCircle, SeesNoShiftInHigherHarmonics) {
  for (int n : {2, 3, 4, 17}) {
    const Circle circle = least_squares_circle(
        around(3600, [n](double theta) { return kR + 5.0 * um * std::cos(n * theta + 1.0); }));
    EXPECT_NEAR((circle.centre - kCentre).norm(), 0.0, 20 * kRounding) << n;
    EXPECT_NEAR(circle.radius, kR, 20 * kRounding) << n;
  }
}

TEST(MinimumZone, OfACircleHasNoWidth) {
  const RingZone zone = minimum_zone(around(720, [](double) { return kR; }));
  EXPECT_NEAR(zone.width(), 0.0, 20 * kRounding);
  EXPECT_NEAR((zone.centre - kCentre).norm(), 0.0, 20 * kRounding);
}

TEST(MinimumZone, OfThreePointsIsTheirCircle) {
  Random random(3);
  const auto points = random.ring(3, 1.0 * mm);
  const RingZone zone = minimum_zone(points);
  EXPECT_NEAR(zone.width(), 0.0, kZoneTol);
}

// A polygon sampled along its edges has the circles R and R cos(pi/n).
TEST(MinimumZone, OfARegularPolygonLiesBetweenItsCircles) {
  for (int n : {16, 17, 36}) {
    std::vector<Vector2d> points;
    for (int i = 0; i < n; ++i) {
      const auto corner = [&](int k) {
        return Vector2d(kR * Vector2d(std::cos(kTurn * k / n), std::sin(kTurn * k / n)));
      };
      for (int k = 0; k < 10; ++k) {
        points.push_back(kCentre + corner(i) + 0.1 * k * (corner(i + 1) - corner(i)));
      }
    }
    const RingZone zone = minimum_zone(points);
    EXPECT_NEAR(zone.outer, kR, kZoneTol) << n;
    EXPECT_NEAR(zone.inner, kR * std::cos(kTurn / 2 / n), kZoneTol) << n;
    EXPECT_NEAR((zone.centre - kCentre).norm(), 0.0, kZoneTol) << n;
  }
}

TEST(MinimumZone, OfAnEllipseIsTheDifferenceOfItsHalfAxes) {
  const double a = kR + 10.0 * um, b = kR - 4.0 * um;
  std::vector<Vector2d> points;
  for (int i = 0; i < 3600; ++i) {
    const double t = kTurn * i / 3600;
    points.push_back(kCentre + Vector2d(a * std::cos(t), b * std::sin(t)));
  }
  const RingZone zone = minimum_zone(points);
  EXPECT_NEAR(zone.width(), 14.0 * um, kZoneTol);
  EXPECT_NEAR((zone.centre - kCentre).norm(), 0.0, kZoneTol);
}

// A flat spike of height h = 8 um and +-5 deg. Moved towards it by x, the centre nears it by
// x cos 5 deg and its foot by x cos 5.1 deg, and leaves the other side by x: best is x = h / 2, and
// next to nothing is gained.
TEST(MinimumZone, OfOneSpikeIsHardlyLessThanItsHeight) {
  constexpr double kSecondOrder = 2e-12;  // m: h^2 / R, times 0.002 by how the distances differ
  const double h = 8.0 * um;
  const auto points = around(3600, [h](double theta) {
    return kR + (std::abs(theta - kTurn / 4) < 5.05 * deg ? h : 0.0);
  });
  EXPECT_NEAR(minimum_zone(points).width(),
              h - 0.5 * h * (std::cos(5.0 * deg) - std::cos(5.1 * deg)), kSecondOrder);
}

// Whatever way the centre goes, it goes away from one of them.
TEST(MinimumZone, OfThreeSpikesCannotBeShiftedAway) {
  const auto points = around(3600, [](double theta) {
    return kR + (std::abs(std::remainder(theta, kTurn / 3)) < 0.02 ? 5.0 * um : 0.0);
  });
  EXPECT_NEAR(minimum_zone(points).width(), 5.0 * um, kZoneTol);
}

// The two radii are held by four points: two and two, three and one or one and three. All centres
// that such four can have, tried.
double by_brute_force(const std::vector<Vector2d>& p) {
  double best = std::numeric_limits<double>::infinity();
  const auto try_centre = [&](const Eigen::Matrix2d& A, const Vector2d& b) {
    if (std::abs(A.determinant()) < 1e-12) return;
    const Vector2d centre = A.inverse() * b;
    if ((centre - kCentre).norm() < 0.2 * kR) best = std::min(best, zone_about(p, centre).width());
  };
  // equal distances to p_i and p_j: (p_i - p_j) . c = (|p_i|^2 - |p_j|^2) / 2
  struct Bisector {
    Eigen::RowVector2d a;
    double b;
  };
  std::vector<Bisector> all;
  for (std::size_t i = 0; i < p.size(); ++i) {
    for (std::size_t j = i + 1; j < p.size(); ++j) {
      all.push_back({(p[i] - p[j]).transpose(), 0.5 * (p[i].squaredNorm() - p[j].squaredNorm())});
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) {  // neighbours share a point: circles through three
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      Eigen::Matrix2d A;
      A << all[i].a, all[j].a;
      try_centre(A, Vector2d(all[i].b, all[j].b));
    }
  }
  return best;
}

TEST(MinimumZone, AgreesWithAllCandidatesTried) {
  constexpr double kBruteTol = 1e-13;  // m: centres by differences of squares of 0.4 m
  Random random(5);
  for (int n = 0; n < 300; ++n) {
    const auto points = random.ring(6 + n % 9, n % 2 == 0 ? 10.0 * um : 500.0 * um);
    EXPECT_NEAR(minimum_zone(points).width(), by_brute_force(points), kBruteTol) << n;
  }
}

// Two paths with a point each at the same angle: how far these are apart is a lower bound, and a
// whole set of centres reaches it.
TEST(MinimumZone, CopesWithACentreThatIsNotUnique) {
  auto points = around(720, [](double) { return kR; });
  const Vector2d out(std::cos(1.0), std::sin(1.0));
  points.push_back(kCentre + (kR + 3.0 * um) * out);
  points.push_back(kCentre + (kR - 4.0 * um) * out);
  // the two are not in line with a shifted centre
  const double slack = 7.0 * um * std::pow(10.0 * um / kR, 2);
  EXPECT_NEAR(minimum_zone(points).width(), 7.0 * um, slack);
}

TEST(MinimumZone, IsNeverWiderThanAboutTheLeastSquaresCentreAndHoldsAllPoints) {
  Random random(6);
  for (int n = 0; n < 20; ++n) {
    const auto points = random.ring(2000, 10.0 * um);
    const RingZone zone = minimum_zone(points);
    EXPECT_LE(zone.width(), zone_about(points, least_squares_circle(points).centre).width());
    for (const Vector2d& p : points) {
      const double rho = (p - zone.centre).norm();
      EXPECT_TRUE(rho >= zone.inner && rho <= zone.outer);
    }
  }
}

}  // namespace
}  // namespace servomill::sim::metrology::circle_fit_test
