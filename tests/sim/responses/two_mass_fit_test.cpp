#include "sim/responses/two_mass_fit.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "tests/text.h"

namespace servomill::sim::responses::two_mass_fit_test {
namespace {

const TwoMass kBench{{200.0, 54.0, 1.0, 2.5, 8.0, 12.0, 6e-4}};

// Lines of 1 Hz with relative noise.
MeasuredResponse lines(const TwoMass& model, double noise, unsigned seed) {
  boost::random::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  MeasuredResponse out;
  for (int f = 11; f <= 250; ++f) {
    ResponseLine line;
    line.frequency = f;
    const Complex exact = model.at(f);
    const double deviation = noise * std::abs(exact) / std::sqrt(2.0);
    line.value = exact + Complex(deviation * normal(generator), deviation * normal(generator));
    line.variance = 2.0 * deviation * deviation;
    out.lines.push_back(line);
  }
  return out;
}

TEST(TwoMass, IsTheQuotientOfItsEquationsOfMotion) {
  // solved as two equations for phi and psi, with J_m = 1
  const double w = 2.0 * std::numbers::pi * 70.0, k = std::pow(2.0 * std::numbers::pi * 54.0, 2);
  const Complex s(0.0, w), link = k + 2.5 * s;
  const Complex a = s * s + 8.0 * s + link, d = s * s + 12.0 * s + link;
  const Complex phi = 200.0 * d / (a * d - link * link) * std::exp(-s * 6e-4);
  EXPECT_NEAR(std::abs(kBench.at(70.0) / phi - 1.0), 0.0, 1e-12);
  EXPECT_NEAR(kBench.resonance(), 54.0 * std::sqrt(2.0), 1e-12);
}

TEST(TwoMassFit, FindsTheBenchWithoutNoise) {
  const TwoMassFit found = fit_two_mass(lines(kBench, 1e-6, 1), "x");
  for (std::size_t k = 0; k < TwoMass::kParameters; ++k) {
    EXPECT_NEAR(found.model.value[k] / kBench.value[k], 1.0, 1e-3) << TwoMass::kNames[k];
  }
  EXPECT_LT(found.median_misfit, 1e-5);
}

TEST(TwoMassFit, AnAngleThatCountsTheOtherWayHasANegativeGain) {
  MeasuredResponse turned = lines(kBench, 1e-6, 1);
  for (ResponseLine& line : turned.lines) line.value = -line.value;
  EXPECT_NEAR(fit_two_mass(turned, "x").model.value[0], -200.0, 0.2);
}

TEST(TwoMassFit, IntervalsHoldTheTruthAsOftenAsTheyClaim) {
  int inside = 0, all = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const TwoMassFit found = fit_two_mass(lines(kBench, 0.01, seed), "x");
    EXPECT_FALSE(found.has_model_error());
    for (std::size_t k = 0; k < TwoMass::kParameters; ++k) {
      inside +=
          std::abs(found.model.value[k] - kBench.value[k]) <= 1.97 * found.standard(k) ? 1 : 0;
      ++all;
    }
  }
  EXPECT_NEAR(static_cast<double>(inside) / all, 0.95, 0.04);
}

TEST(TwoMassFit, AMisfitBeyondTheNoiseWidensTheIntervals) {
  MeasuredResponse wrong = lines(kBench, 1e-3, 1);
  for (ResponseLine& line : wrong.lines) line.value *= 1.0 + 0.05 * std::sin(line.frequency / 15.0);
  const TwoMassFit found = fit_two_mass(wrong, "x");
  EXPECT_TRUE(found.has_model_error());
  EXPECT_GT(found.standard(0), 5.0 * fit_two_mass(lines(kBench, 1e-3, 1), "x").standard(0));
}

TEST(TwoMassFit, RefusesAResponseOfOneMass) {
  MeasuredResponse one;
  for (int f = 10; f < 100; ++f) {
    one.lines.push_back({.frequency = static_cast<double>(f), .value = -1.0 / (f * f)});
  }
  EXPECT_EQ(fault_messages([&] { fit_two_mass(one, "x"); }),
            "shows no antiresonance followed by a resonance: a two-mass model cannot be fitted\n");
}

}  // namespace
}  // namespace servomill::sim::responses::two_mass_fit_test
