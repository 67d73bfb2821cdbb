// The nearest offset within the limits, against solutions found in another way.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "bounded_path.h"

namespace servomill::sim::preparation::nearest_offset_test {
namespace {

using namespace bounded_path;

// The nearest series with |D x| <= limit, D differences of one order: x = u - D^T lambda, where
// each lambda is 0 or its row is on the limit, on the side to which it pushes. The worst row joins
// those on the limit, until none is beyond it; rows whose lambda would change its sign leave.
// Source: Lawson, Hanson, Solving Least Squares Problems, 1995, chapter 23 (algorithm NNLS).
class Nearest {
 public:
  Nearest(const Series& u, std::size_t order, double limit)
      : u_(u), order_(order), limit_(limit), stencil_(kStencils[order - 1]) {}

  Series find() {
    constexpr int kTrials = 2000;
    Series x = u_;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::size_t worst = 0;
      for (std::size_t n = 1; n + 2 < u_.size(); ++n) {
        if (worst == 0 || size(x, n) > size(x, worst)) worst = n;
      }
      if (size(x, worst) <= limit_ * (1.0 + 1e-6)) return x;
      on_limit_.push_back({worst, difference(x, order_, worst) > 0.0 ? 1.0 : -1.0, 0.0});
      solve();
      x = u_;
      for (const Row& one : on_limit_) {
        for (std::size_t k = 0; k < 4; ++k) x[one.n - 1 + k] -= one.lambda * stencil_[k];
      }
    }
    ADD_FAILURE() << "no series found";
    return x;
  }

 private:
  struct Row {
    std::size_t n;
    double side, lambda;
  };
  static constexpr std::array<std::array<double, 4>, 3> kStencils = {
      {{0, -1, 1, 0}, {1, -2, 1, 0}, {-1, 3, -3, 1}}};

  double size(const Series& x, std::size_t n) const { return std::abs(difference(x, order_, n)); }

  void solve() {
    while (!on_limit_.empty()) {
      const Eigen::VectorXd wanted = solution();
      double step = 1.0;
      for (std::size_t p = 0; p < on_limit_.size(); ++p) {
        const double from = on_limit_[p].lambda, to = wanted[static_cast<Eigen::Index>(p)];
        if (to * on_limit_[p].side < 0.0) step = std::min(step, from / (from - to));
      }
      for (std::size_t p = 0; p < on_limit_.size(); ++p) {
        Row& one = on_limit_[p];
        one.lambda += step * (wanted[static_cast<Eigen::Index>(p)] - one.lambda);
      }
      if (step == 1.0) return;
      std::erase_if(on_limit_,
                    [&](const Row& one) { return one.lambda * one.side <= 1e-9 * um * um; });
    }
  }

  // (D D^T)^-1 (D u - limit) of the rows on the limit.
  Eigen::VectorXd solution() const {
    const auto rows = static_cast<Eigen::Index>(on_limit_.size());
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(rows, rows);
    Eigen::VectorXd beyond(rows);
    for (Eigen::Index p = 0; p < rows; ++p) {
      const Row& one = on_limit_[static_cast<std::size_t>(p)];
      beyond[p] = difference(u_, order_, one.n) - one.side * limit_;
      for (Eigen::Index q = 0; q < rows; ++q) {
        const std::size_t other = on_limit_[static_cast<std::size_t>(q)].n;
        const std::size_t apart = std::max(one.n, other) - std::min(one.n, other);
        for (std::size_t k = 0; k + apart < 4; ++k) gram(p, q) += stencil_[k] * stencil_[k + apart];
      }
    }
    return gram.ldlt().solve(beyond);
  }

  const Series& u_;
  std::size_t order_;
  double limit_;
  std::array<double, 4> stencil_;
  std::vector<Row> on_limit_;
};

double norm(const Series& a, const Series& b) {
  double sum = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += (a[n] - b[n]) * (a[n] - b[n]);
  return std::sqrt(sum);
}

double largest_difference(const Series& a, const Series& b) {
  double out = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) out = std::max(out, std::abs(a[n] - b[n]));
  return out;
}
double largest_of(const Series& u) { return largest_difference(u, Series(u.size(), 0.0)); }

// The search ends at the first series within the limits.
constexpr double kNear = 0.05;  // share of the offset

// u' = u - D^T (D D^T)^-1 (D u - limit) with D = (-1 3 -3 1), D D^T = 20.
TEST(NearestWithin, OfOneRowBeyondItsJerkIsNearItsProjection) {
  constexpr double kNearJerk = 0.01;  // share of the offset
  const Bounded bounded(standing(1.0), alike());
  const double limit = (1.0 - kBesides) * kJ * std::pow(kRow, 3);
  for (const double side : {1.0, -1.0}) {
    const Series u = with_one_jerk(bounded.rows(), 500, side * 1.3 * limit);
    ASSERT_NEAR(difference(u, 3, 500), side * 1.3 * limit, 1e-6 * limit);
    ASSERT_LT(std::abs(difference(u, 3, 499)), 0.2 * limit);
    Series expected = u;
    const double lambda = side * 0.3 * limit / 20.0;
    expected[499] += lambda;
    expected[500] -= 3.0 * lambda;
    expected[501] += 3.0 * lambda;
    expected[502] -= lambda;
    ASSERT_LE(largest_difference(expected, Nearest(u, 3, limit).find()), 1e-6 * limit);
    const Series near = X_of(bounded.limits.nearest_within(offset_of_X(u)));
    EXPECT_LE(largest_difference(near, expected), kNearJerk * largest_of(u));
    EXPECT_LE(difference(near, 3, 500) * side, (1.0 + kRounding) * limit);
  }
}

// A burst that exceeds one limit by a share, where the others are far away.
struct Excess {
  Series u;
  double limit;  // of the differences
  Bounded bounded;
  JointLimits limits;

  Excess(std::size_t order, double f, double share)
      : bounded(standing(1.0), limits_of(order)), limits(limits_of(order)) {
    const double full = order == 1 ? kV : order == 2 ? kA : kJ;
    u = burst(bounded.rows(), 1 * um, f, 0.5);
    const double factor = share * full / largest(u, order);
    for (double& one : u) one *= factor;
    limit = (1.0 - kBesides) * full * std::pow(kRow, static_cast<double>(order));
  }
  static JointLimits limits_of(std::size_t order) {
    return alike(order == 1 ? kV : 1e3, order == 2 ? kA : 1e6, order == 3 ? kJ : 1e9);
  }
};

TEST(NearestWithin, OfALargeExcessIsTheNearest) {
  constexpr double kApart = 0.05;  // of the distance
  for (const std::size_t order : {1U, 2U, 3U}) {
    const Excess of(order, 60.0, 2.0);
    const Series near = X_of(of.bounded.limits.nearest_within(offset_of_X(of.u)));
    const Series best = Nearest(of.u, order, of.limit).find();
    EXPECT_TRUE(keeps(of.bounded.limits.demands(offset_of_X(near)), of.limits)) << order;
    EXPECT_LE(norm(near, of.u), 1.01 * norm(best, of.u)) << order;
    EXPECT_LE(norm(near, best), kApart * norm(best, of.u)) << order;
  }
}

TEST(NearestWithin, OfAnyExcessIsNearTheNearest) {
  for (const std::size_t order : {2U, 3U}) {
    for (const double f : {15.0, 30.0, 60.0}) {
      for (const double share : {1.05, 1.3, 2.0}) {
        const Excess of(order, f, share);
        const Series near = X_of(of.bounded.limits.nearest_within(offset_of_X(of.u)));
        const Series best = Nearest(of.u, order, of.limit).find();
        EXPECT_TRUE(keeps(of.bounded.limits.demands(offset_of_X(near)), of.limits))
            << order << ", " << f << " Hz, " << share;
        EXPECT_LE(largest_difference(near, best), kNear * largest_of(of.u))
            << order << ", " << f << " Hz, " << share;
      }
    }
  }
}

// At the largest speed of X nothing may be added, and what is taken away cannot be made up for.
TEST(NearestWithin, OfAPathOnItsLimitIsNoOffset) {
  constexpr double kFeed = 2 * mm;  // m/s
  const Trajectory path = moving(4 * mm, kFeed);
  const Bounded bounded(path, alike(kFeed));
  for (const double A : {20 * um, -20 * um}) {
    Series u(bounded.rows(), 0.0);
    for (std::size_t n = 0; n < u.size(); ++n) {
      const double x = (static_cast<double>(n) * kRow - 0.5 * path.duration()) / 0.1;
      if (std::abs(x) < 1.0) u[n] = A * std::pow(1.0 - x * x, 4);
    }
    ASSERT_GT(largest(u, 1), 0.1 * kFeed);
    const std::vector<Joints> near = bounded.limits.nearest_within(offset_of_X(u));
    EXPECT_LE(largest_of(X_of(near)), 0.01 * std::abs(A));
    EXPECT_TRUE(keeps(bounded.limits.demands(near), alike(kFeed)));
    std::vector<Joints> of_Y(u.size(), Joints::Zero());
    for (std::size_t n = 0; n < u.size(); ++n) of_Y[n][1] = u[n];
    EXPECT_EQ(bounded.limits.nearest_within(of_Y), of_Y) << "Y stands and has all of its limits";
  }
}

TEST(NearestWithin, OfConstantOffsetIsItselfOnAnyPath) {
  const Bounded bounded(moving(0.4, 0.2), alike(0.2));
  const std::vector<Joints> u(bounded.rows(), Joints::Constant(7 * um));
  EXPECT_EQ(bounded.limits.nearest_within(u), u);
}

}  // namespace
}  // namespace servomill::sim::preparation::nearest_offset_test
