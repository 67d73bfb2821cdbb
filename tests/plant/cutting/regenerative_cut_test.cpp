#include "tests/plant/cutting/regenerative_cut.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::plant::regenerative_cut_test {
namespace {

constexpr double kPi = std::numbers::pi;
using Complex = std::complex<double>;

const CuttingCoefficients& steel() { return find_material("42CrMo4")->typical; }

// 500 Hz, 3 %, 20 N/um, normal to the feed.
const ChatterMode kMode{.stiffness = 20e6, .frequency = 2.0 * kPi * 500.0, .damping = 0.03};

Complex receptance(double w) {
  const double r = w / kMode.frequency;
  return 1.0 / (kMode.stiffness * Complex(1.0 - r * r, 2.0 * kMode.damping * r));
}

SteadyCut slot(double turns) {
  return {.coefficients = steel(), .teeth = 4, .from = 0.0, .to = kPi, .turns = turns};
}

// 1 + a K_rc (1 - exp(-i w T)) G = 0: with a = -1 / (2 K_rc Re G), exp(-i w T) = 1 - 2 Re G / G.
double limit(double w) { return -1.0 / (2.0 * steel().Krc * receptance(w).real()); }
double phase(double w) {  // of w T, in [0, 2 pi)
  const Complex G = receptance(w);
  const double angle = -std::arg(1.0 - 2.0 * G.real() / G);
  return angle < 0.0 ? angle + 2.0 * kPi : angle;
}

// The lobes at a time from tooth to tooth: the lowest limit over all chatter frequencies, and the
// second lowest, which is far away off the cusps.
struct Lobes {
  double lowest = 1.0, second = 1.0;
};
Lobes lobes(double T) {
  Lobes out;
  const auto excess = [&](double w, int k) { return phase(w) + 2.0 * kPi * k - w * T; };
  for (int k = 0; k < 12; ++k) {
    const double first = kMode.frequency * (1.0 + 1e-6), step = 1e-4 * kMode.frequency;
    for (double w = first; w < 3.0 * kMode.frequency; w += step) {
      double low = w, high = w + step;
      if (excess(low, k) * excess(high, k) > 0.0) continue;
      if (std::abs(excess(low, k) - excess(high, k)) > kPi) continue;  // jump of the phase
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (excess(low, k) * excess(middle, k) > 0.0 ? low : high) = middle;
      }
      const double a = limit(low);
      if (a < out.lowest) {
        out.second = out.lowest;
        out.lowest = a;
      } else {
        out.second = std::min(out.second, a);
      }
    }
  }
  return out;
}

TEST(Regeneration, limit_of_a_slot_is_that_of_constant_directional_factors) {
  for (const double turns : {45.0, 62.0, 80.0, 108.0, 150.0}) {
    const Lobes expected = lobes(1.0 / (4.0 * turns));
    ASSERT_GT(expected.second, 1.1 * expected.lowest) << "off the cusps";
    const double depth = stable_depth(slot(turns), kMode, 3.0 * expected.lowest, 100);
    EXPECT_NEAR(depth, expected.lowest, 0.01 * expected.lowest) << turns;
  }
}

// Semi-discretisation of first order (Insperger, Stepan 2011): x' = A(t) x + B(t) x(t - T), the
// delayed state linear over an interval, the matrices by their means. Independent of the
// simulation.
Complex semi_discretisation(const SteadyCut& cut, int intervals) {
  const double T = 1.0 / (cut.turns * cut.teeth), dt = T / intervals, w = kMode.frequency;
  const auto alpha = [&](double t) {  // d . (K_tc t + K_rc r) (r . d) of the tooth in the cut
    const double phi = 2.0 * kPi * cut.turns * t;
    if (phi < cut.from || phi >= cut.to) return 0.0;
    const double s = std::sin(phi), c = std::cos(phi);
    return (-cut.coefficients.Ktc * s + cut.coefficients.Krc * c) * c;
  };
  const int n = intervals + 2;  // q, dq, q of the intervals before
  Eigen::MatrixXd product = Eigen::MatrixXd::Identity(n, n);
  for (int i = 0; i < intervals; ++i) {
    double mean = 0.0;
    constexpr int kParts = 200;
    for (int part = 0; part < kParts; ++part)
      mean += alpha((i + (part + 0.5) / kParts) * dt) / kParts;
    const double gain = w * w / kMode.stiffness * cut.depth * mean;
    Eigen::Matrix2d A;
    A << 0.0, 1.0, -w * w - gain, -2.0 * kMode.damping * w;
    // exp of A and of the delayed displacement, constant and linear, by one exponential
    Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
    M.topLeftCorner<2, 2>() = A * dt;
    M(1, 2) = gain * dt;
    M(2, 3) = 1.0;
    Eigen::Matrix4d E = Eigen::Matrix4d::Identity(), term = E;
    for (int k = 1; k < 30; ++k) {
      term = term * M / k;
      E += term;
    }
    Eigen::MatrixXd step = Eigen::MatrixXd::Zero(n, n);
    step.topLeftCorner(2, 2) = E.topLeftCorner<2, 2>();
    // delayed displacement: q_{i-m} at the begin of the interval, q_{i-m+1} at its end
    step.block(0, n - 1, 2, 1) += E.block<2, 1>(0, 2) - E.block<2, 1>(0, 3);
    step.block(0, n - 2, 2, 1) += E.block<2, 1>(0, 3);
    step(2, 0) = 1.0;
    for (int k = 3; k < n; ++k) step(k, k - 1) = 1.0;
    product = step * product;
  }
  const Eigen::VectorXcd values = product.eigenvalues();
  Complex largest = 0.0;
  for (const Complex& value : values) {
    if (std::abs(value) > std::abs(largest)) largest = value;
  }
  return largest;
}

double semi_discretised_depth(SteadyCut cut, double low, double high) {
  while (high - low > 1e-3 * high) {
    cut.depth = 0.5 * (low + high);
    (std::abs(semi_discretisation(cut, 80)) < 1.0 ? low : high) = cut.depth;
  }
  return 0.5 * (low + high);
}

TEST(Regeneration, limit_at_low_immersion_is_that_of_semi_discretisation) {
  int flips = 0;
  for (const double turns : {130.0, 170.0, 190.0, 310.0, 350.0, 420.0}) {
    SteadyCut cut{
        .coefficients = steel(), .teeth = 2, .from = 0.0, .to = 12.8 * deg, .turns = turns};
    const double depth = stable_depth(cut, kMode, 100 * mm, 300);
    const double expected = semi_discretised_depth(cut, 0.7 * depth, 1.3 * depth);
    EXPECT_NEAR(depth, expected, 0.02 * expected) << turns;
    cut.depth = depth;
    const Complex of_teeth = semi_discretisation(cut, 80);
    const Multiplier found = chatter_multiplier(cut, kMode, 300);
    EXPECT_NEAR(found.real, of_teeth.real(), 0.03) << turns;
    flips += std::abs(found.imaginary) < 1e-3 && found.real < -0.99 ? 1 : 0;
  }
  EXPECT_GE(flips, 1) << "period doubling";
}

TEST(Regeneration, without_a_cut_is_the_decay_of_the_mode) {
  SteadyCut cut = slot(80.0);
  RegenerativeCut run(cut, kMode, RegenerativeCut::Chips::real, 50);
  run.start(1 * um, 0.0);
  const double dt = 1.0 / (80.0 * 4.0 * 50.0), z = kMode.damping, w = kMode.frequency;
  const double wd = w * std::sqrt(1.0 - z * z);
  for (int n = 1; n <= 1000; ++n) {
    run.step();
    const double t = n * dt;
    const double decay =
        1 * um * std::exp(-z * w * t) * (std::cos(wd * t) + z * w / wd * std::sin(wd * t));
    ASSERT_NEAR(run.q(), decay, 1e-16) << n;
  }
}

// Edges that need no force: the slot loads the mode with a constant a K_tc c.
TEST(Regeneration, of_a_stable_cut_ends_in_its_static_deflection) {
  SteadyCut cut = slot(80.0);
  cut.coefficients.Kte = cut.coefficients.Kre = cut.coefficients.Kae = 0.0;
  cut.feed = 0.05 * mm;
  cut.depth = 0.5 * lobes(1.0 / (4.0 * 80.0)).lowest;
  RegenerativeCut run(cut, kMode, RegenerativeCut::Chips::real, 100);
  for (int n = 0; n < 400 * 100; ++n) run.step();
  const double F = cut.depth * cut.coefficients.Ktc * cut.feed;
  EXPECT_NEAR(run.force(), F, 1e-6 * F);
  EXPECT_NEAR(run.q(), F / kMode.stiffness, 1e-6 * F / kMode.stiffness);
}

// Teeth that leave the cut bound the vibration: it neither dies out nor grows for ever.
TEST(Regeneration, of_an_unstable_cut_ends_in_a_bounded_vibration) {
  SteadyCut cut = slot(80.0);
  cut.feed = 0.05 * mm;
  cut.depth = 1.5 * lobes(1.0 / (4.0 * 80.0)).lowest;
  RegenerativeCut run(cut, kMode, RegenerativeCut::Chips::real, 100);
  const auto range_of_passages = [&](int passages) {
    double low = 1.0, high = -1.0;
    for (int n = 0; n < passages * 100; ++n) {
      run.step();
      low = std::min(low, run.q());
      high = std::max(high, run.q());
    }
    return high - low;
  };
  range_of_passages(500);
  const double range = range_of_passages(100), later = range_of_passages(100);
  EXPECT_GT(range, 0.2 * cut.feed);
  EXPECT_LT(range, 20.0 * cut.feed);
  EXPECT_NEAR(later, range, 0.1 * range);
}

// The limit of a slot is that of the continuous equation: halving the step quarters its error.
TEST(Regeneration, is_of_second_order_in_the_step) {
  const double exact = lobes(1.0 / (4.0 * 80.0)).lowest;
  const auto growth = [&](int steps) {
    SteadyCut cut = slot(80.0);
    cut.depth = exact;
    return chatter_multiplier(cut, kMode, steps).magnitude() - 1.0;
  };
  EXPECT_NEAR(growth(80) / growth(40), 0.25, 0.03);
  EXPECT_NEAR(growth(160) / growth(80), 0.25, 0.03);
}

}  // namespace
}  // namespace servomill::plant::regenerative_cut_test
