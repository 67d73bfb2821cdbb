#include "sim/metrology/linear_program.h"

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <cassert>
#include <cmath>
#include <utility>

namespace servomill::sim::metrology {
namespace {

constexpr double kRounding = 1e-13;  // of what is added up, for components of the order of 1

// Returns true if x is outside by more than rounding.
bool cuts_off(const HalfSpace& half, const SmallVector& x) {
  const double size = 1.0 + half.a.cwiseAbs().dot(x.cwiseAbs()) + std::abs(half.b);
  return half.a.dot(x) > half.b + kRounding * size;
}

// The vector without its component k.
SmallVector without(const SmallVector& v, Eigen::Index k) {
  SmallVector out(v.size() - 1);
  out << v.head(k), v.tail(v.size() - k - 1);
  return out;
}

// The half-space as seen on the edge of another one, where x_k follows from the other variables.
HalfSpace on_edge(const HalfSpace& half, const HalfSpace& edge, Eigen::Index k) {
  const double share = half.a[k] / edge.a[k];
  return {without(half.a - share * edge.a, k), half.b - share * edge.b};
}

// x_k with edge.a . x = edge.b, put into its place among the others.
SmallVector lifted(const SmallVector& others, const HalfSpace& edge, Eigen::Index k) {
  SmallVector x(others.size() + 1);
  x << others.head(k), 0.0, others.tail(others.size() - k);
  x[k] = (edge.b - edge.a.dot(x)) / edge.a[k];
  return x;
}

std::optional<SmallVector> minimize_on_line(double cost, double low, double high,
                                            const std::vector<HalfSpace>& constraints) {
  double size = 1.0 + std::max(std::abs(low), std::abs(high));
  for (const HalfSpace& half : constraints) {
    const double a = half.a[0];
    size = std::max(size, std::abs(half.b));
    if (a > kRounding) high = std::min(high, half.b / a);
    if (a < -kRounding) low = std::max(low, half.b / a);
    if (std::abs(a) <= kRounding && half.b < -kRounding * size) return std::nullopt;
  }
  if (low > high + kRounding * size) return std::nullopt;
  return SmallVector::Constant(1, cost > 0.0 ? low : high);
}

// The bounds are the first 2 d constraints, so that there is a best x at any time.
std::optional<SmallVector> solve(const SmallVector& cost, const SmallVector& bound,
                                 const std::vector<HalfSpace>& constraints) {
  const Eigen::Index d = cost.size();
  if (d == 1) return minimize_on_line(cost[0], -bound[0], bound[0], constraints);
  SmallVector x(d);
  for (Eigen::Index k = 0; k < d; ++k) x[k] = cost[k] > 0.0 ? -bound[k] : bound[k];
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const HalfSpace& edge = constraints[i];
    if (!cuts_off(edge, x)) continue;
    Eigen::Index k = 0;
    if (edge.a.cwiseAbs().maxCoeff(&k) <= kRounding) return std::nullopt;  // 0 <= b < 0

    // the same on the edge; the bounds of x_k become two constraints
    std::vector<HalfSpace> before;
    before.reserve(i + 2);
    for (const double sign : {1.0, -1.0}) {
      before.push_back(on_edge({sign * SmallVector::Unit(d, k), bound[k]}, edge, k));
    }
    for (std::size_t j = 0; j < i; ++j) before.push_back(on_edge(constraints[j], edge, k));
    const auto share = SmallVector(cost - cost[k] / edge.a[k] * edge.a);
    const auto others = solve(without(share, k), without(bound, k), before);
    if (!others) return std::nullopt;
    x = lifted(*others, edge, k);
  }
  return x;
}

}  // namespace

std::optional<SmallVector> minimize(const SmallVector& cost, const SmallVector& bound,
                                    std::vector<HalfSpace> constraints) {
  assert(cost.size() >= 1 && cost.size() <= 6 && bound.size() == cost.size());
  boost::random::mt19937 random(1);
  for (std::size_t i = constraints.size(); i > 1; --i) {
    const boost::random::uniform_int_distribution<std::size_t> below(0, i - 1);
    std::swap(constraints[i - 1], constraints[below(random)]);
  }
  return solve(cost, bound, constraints);
}

}  // namespace servomill::sim::metrology
