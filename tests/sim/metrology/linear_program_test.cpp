#include "sim/metrology/linear_program.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <limits>

namespace servomill::sim::metrology::linear_program_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kTol = 1e-10;  // numbers of the order of 1; the program's own slack is 1e-13

TEST(LinearProgram, StopsAtTheBoundsWhereNothingElseDoes) {
  const auto x = minimize(Vector3d(1.0, -2.0, 0.5), Vector3d(3.0, 4.0, 5.0), {});
  ASSERT_TRUE(x);
  EXPECT_TRUE(x->isApprox(Vector3d(-3.0, 4.0, -5.0), kTol));
}

// max 3 x + 2 y with x + y <= 4, x + 3 y <= 6, x <= 3: the corner (3, 1)
TEST(LinearProgram, FindsTheCornerOfATextbookExample) {
  const auto x =
      minimize(Vector2d(-3.0, -2.0), Vector2d(10.0, 10.0),
               {{Vector2d(1.0, 1.0), 4.0}, {Vector2d(1.0, 3.0), 6.0}, {Vector2d(1.0, 0.0), 3.0}});
  ASSERT_TRUE(x);
  EXPECT_NEAR((*x - Vector2d(3.0, 1.0)).norm(), 0.0, kTol);
}

TEST(LinearProgram, SaysWhenThereIsNoPoint) {
  EXPECT_FALSE(minimize(Vector2d(1.0, 1.0), Vector2d(10.0, 10.0),
                        {{Vector2d(1.0, 1.0), -1.0}, {Vector2d(-1.0, -1.0), 0.5}}));
  EXPECT_FALSE(minimize(Vector2d(1.0, 1.0), Vector2d(1.0, 1.0), {{Vector2d(1.0, 0.0), -2.0}}));
}

TEST(LinearProgram, TakesTheSameConstraintTwice) {
  const HalfSpace half = {Vector2d(1.0, 2.0), 1.0};
  const auto x =
      minimize(Vector2d(-1.0, -2.0), Vector2d(1.0, 1.0), {half, half, half, {-half.a, -half.b}});
  ASSERT_TRUE(x);
  EXPECT_NEAR(half.a.dot(*x), 1.0, kTol);
}

// The optimum lies at a corner of three planes: all corners tried.
double best_corner(const Vector3d& cost, const std::vector<HalfSpace>& all) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      for (std::size_t k = j + 1; k < all.size(); ++k) {
        Eigen::Matrix3d A;
        A << all[i].a.transpose(), all[j].a.transpose(), all[k].a.transpose();
        if (std::abs(A.determinant()) < 1e-9) continue;
        const Vector3d x = A.inverse() * Vector3d(all[i].b, all[j].b, all[k].b);
        bool inside = true;
        for (const HalfSpace& half : all) inside &= half.a.dot(x) <= half.b + kTol;
        if (inside) best = std::min(best, cost.dot(x));
      }
    }
  }
  return best;
}

TEST(LinearProgram, AgreesWithAllCornersTried) {
  boost::random::mt19937 random(4);
  const boost::random::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int n = 0; n < 200; ++n) {
    const auto vector = [&] { return Vector3d(number(random), number(random), number(random)); };
    const Vector3d cost = vector();
    std::vector<HalfSpace> constraints;
    for (int i = 0; i < 12; ++i) constraints.push_back({vector(), 0.6 + 0.6 * number(random)});
    const auto x = minimize(cost, Vector3d(1.0, 2.0, 3.0), constraints);
    ASSERT_TRUE(x) << "x = 0 is inside";

    std::vector<HalfSpace> all = constraints;
    for (int k = 0; k < 3; ++k) {
      for (const double sign : {1.0, -1.0}) all.push_back({sign * Vector3d::Unit(k), k + 1.0});
    }
    for (const HalfSpace& half : all) EXPECT_LE(half.a.dot(*x), half.b + kTol) << n;
    EXPECT_NEAR(cost.dot(*x), best_corner(cost, all), kTol) << n;
  }
}

}  // namespace
}  // namespace servomill::sim::metrology::linear_program_test
