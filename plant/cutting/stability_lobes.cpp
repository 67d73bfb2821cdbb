#include "plant/cutting/stability_lobes.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace servomill::plant {
namespace {

using Complex = std::complex<double>;

constexpr double kPi = std::numbers::pi, kFullTurn = 2.0 * kPi;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Eigenvalues m of G A_0 at a frequency.
using Pair = std::array<Complex, 2>;

class OrientedReceptance {
 public:
  OrientedReceptance(const FlankEngagement& cut, std::span<const ChatterMode> modes)
      : modes_(modes) {
    constexpr double kThin = 1e-6;  // m: the helix does not count
    const PeriodicCut thin = cut.at(kThin, 1.0);
    A_ = directional_factors(thin.coefficients, thin.teeth, thin.slices, 1).front() / kThin;
  }

  Pair at(double w) const {
    const Eigen::Matrix2cd M = receptance(modes_, w) * A_;
    const Complex half = 0.5 * M.trace();
    const Complex root = std::sqrt(half * half - M.determinant());
    return {half + root, half - root};
  }
  // The same, in the order of their neighbours.
  Pair following(const Pair& before, double w) const {
    Pair m = at(w);
    const double same = std::abs(m[0] - before[0]) + std::abs(m[1] - before[1]);
    const double other = std::abs(m[1] - before[0]) + std::abs(m[0] - before[1]);
    if (other < same) std::swap(m[0], m[1]);
    return m;
  }

 private:
  std::span<const ChatterMode> modes_;
  Eigen::Matrix2d A_;
};

// Angle by which (2) is missed, in (-pi, pi].
double excess(Complex m, double w, double T) {
  return std::remainder(kPi + 2.0 * std::arg(m) - w * T, kFullTurn);
}

}  // namespace

PeriodicCut FlankEngagement::at(double depth, double turns) const {
  return {coefficients, teeth, turns,
          flank_slices(depth, from, to, helix, radius > 0.0 ? radius : 1.0)};
}

Eigen::Matrix2cd receptance(std::span<const ChatterMode> modes, double w) {
  Eigen::Matrix2cd G = Eigen::Matrix2cd::Zero();
  for (const ChatterMode& mode : modes) {
    const double r = w / mode.frequency;
    const Complex g = 1.0 / (mode.stiffness * Complex(1.0 - r * r, 2.0 * mode.damping * r));
    G += g * (mode.direction * mode.direction.transpose()).cast<Complex>();
  }
  return G;
}

StabilityLimit zeroth_order_limit(const FlankEngagement& cut, std::span<const ChatterMode> modes,
                                  double turns) {
  constexpr double kStep = 0.05;    // of the half-power width of the sharpest mode
  constexpr double kHighest = 4.0;  // times the frequency of the fastest mode
  constexpr double kPhase = 0.3;    // rad of w T a step
  constexpr double kNone = 1e-9;    // eigenvalue of a receptance in one direction, relative
  const double T = 1.0 / (turns * cut.teeth);
  double step = kPhase / T, highest = 0.0;
  for (const ChatterMode& mode : modes) {
    step = std::min(step, kStep * mode.damping * mode.frequency);
    highest = std::max(highest, kHighest * mode.frequency);
  }
  const OrientedReceptance M(cut, modes);
  StabilityLimit lowest{.depth = kInfinite};
  Pair before = M.at(step);
  for (double w = step; w < highest; w += step) {
    const Pair after = M.following(before, w + step);
    for (std::size_t i = 0; i < 2; ++i) {
      const double first = excess(before[i], w, T), last = excess(after[i], w + step, T);
      const bool crosses = first * last <= 0.0 && std::abs(first - last) < kPi;
      if (!crosses || std::abs(after[i]) < kNone * std::abs(after[1 - i])) continue;
      double low = w, high = w + step;
      Pair m = before;
      // Bisection down to the rounding of a double: an interval of 1 over 2^50.
      constexpr int kHalvings = 50;
      for (int n = 0; n < kHalvings; ++n) {
        const double middle = 0.5 * (low + high);
        m = M.following(before, middle);
        (first * excess(m[i], middle, T) > 0.0 ? low : high) = middle;
      }
      const double depth = -1.0 / (2.0 * m[i].real());
      if (depth > 0.0 && depth < lowest.depth) lowest = {depth, low / kFullTurn, Chatter::hopf};
    }
    before = after;
  }
  return lowest;
}

StabilityLimit limit_of_stability(const FlankEngagement& cut, std::span<const ChatterMode> modes,
                                  double turns, double deepest) {
  constexpr double kShallowest = 0.02;  // of the deepest
  constexpr double kGrowth = 1.1;
  constexpr double kDepthTol = 1e-3;  // relative
  ChatterAnalysis analysis(modes);
  ChatterStability found;
  double low = 0.0, high = kShallowest * deepest;
  while ((found = analysis.of(cut.at(high, turns))).is_stable()) {
    if (high >= deepest) return {.depth = kInfinite};
    low = high;
    high = std::min(kGrowth * high, deepest);
  }
  while (high - low > kDepthTol * high) {
    const double middle = 0.5 * (low + high);
    const ChatterStability at = analysis.of(cut.at(middle, turns));
    (at.is_stable() ? low : high) = middle;
    if (!at.is_stable()) found = at;
  }
  return {0.5 * (low + high), found.frequency, found.kind()};
}

}  // namespace servomill::plant
