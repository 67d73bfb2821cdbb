#include "sim/responses/local_polynomial.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "sim/responses/rational_fit.h"
#include "tests/text.h"

namespace servomill::sim::responses::local_polynomial_test {
namespace {

constexpr double kRate = 1000.0, kTurn = 2.0 * std::numbers::pi;

// A resonance at 60 Hz with a damping of 5 %, as a difference equation: y = (b1 u1 + b2 u2) - a1 y1
// - a2 y2 of the samples before. Its exact response is known.
struct Resonator {
  double r = std::exp(-0.05 * kTurn * 60.0 / kRate), w = kTurn * 60.0 / kRate;
  Complex at(double f) const {
    const Complex z = std::polar(1.0, -kTurn * f / kRate);
    return (0.02 * z + 0.015 * z * z) / (1.0 - 2.0 * r * std::cos(w) * z + r * r * z * z);
  }
  std::vector<double> run(const std::vector<double>& u) const {
    std::vector<double> y(u.size(), 0.0);
    for (std::size_t n = 2; n < u.size(); ++n) {
      y[n] =
          0.02 * u[n - 1] + 0.015 * u[n - 2] + 2.0 * r * std::cos(w) * y[n - 1] - r * r * y[n - 2];
    }
    return y;
  }
};

std::vector<double> chirp(std::size_t samples) {
  std::vector<double> u;
  for (std::size_t n = 0; n < samples; ++n) {
    const double t = static_cast<double>(n) / kRate;
    const double end = static_cast<double>(samples) / kRate;
    u.push_back(std::sin(kTurn * (5.0 * t + 0.5 * (200.0 - 5.0) * t * t / end)));
  }
  return u;
}

// Shift register of 13 bits, each value two samples long.
std::vector<double> binary(std::size_t samples) {
  std::vector<double> u;
  std::uint32_t bits = 1;
  while (u.size() < samples) {
    const std::uint32_t next = (bits ^ (bits >> 2) ^ (bits >> 3) ^ (bits >> 5)) & 1u;
    bits = (bits >> 1) | (next << 12);
    for (int twice = 0; twice < 2; ++twice) u.push_back((bits & 1u) != 0 ? 1.0 : -1.0);
  }
  u.resize(samples);
  return u;
}

std::vector<double> with_noise(std::vector<double> y, double rms, unsigned seed) {
  boost::random::mt19937 generator(seed);
  boost::random::normal_distribution<double> normal(0.0, rms);
  for (double& sample : y) sample += normal(generator);
  return y;
}

LocalPolynomialSettings settings() {
  LocalPolynomialSettings s;
  s.rate = kRate;
  s.from = 20.0;
  s.to = 150.0;
  return s;
}

TEST(LocalPolynomial, FindsTheResponseInAChirpAndInABinarySignal) {
  const Resonator system;
  for (const auto& u : {chirp(16000), binary(16000)}) {
    const MeasuredResponse found = local_polynomial(u, system.run(u), settings(), "a.csv");
    ASSERT_GT(found.lines.size(), 1000u);
    double worst = 0.0;
    for (const ResponseLine& line : found.lines) {
      worst = std::max(worst, std::abs(line.value / system.at(line.frequency) - 1.0));
    }
    EXPECT_LT(worst, 2e-3) << "transient and curvature are taken into account";
  }
}

// 95 % of the circles hold the response: the claim of the method.
TEST(LocalPolynomial, ItsCirclesHoldTheResponse) {
  const Resonator system;
  const auto u = binary(16000);
  std::size_t inside = 0, all = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const auto y = with_noise(system.run(u), 0.02, seed);
    for (const ResponseLine& line : local_polynomial(u, y, settings(), "a.csv").lines) {
      inside += std::abs(line.value - system.at(line.frequency)) <= line.radius_95 ? 1 : 0;
      ++all;
    }
  }
  EXPECT_NEAR(static_cast<double>(inside) / static_cast<double>(all), 0.95, 0.015);
}

TEST(LocalPolynomial, NeighboursShareTheirSamples) {
  const auto u = binary(16000);
  const double shared = local_polynomial(u, Resonator().run(u), settings(), "a").lines_per_estimate;
  EXPECT_GT(shared, 2.0);
  EXPECT_LT(shared, 13.0) << "lines of a window";
}

// Poles of many records scatter as the fit of one claims.
TEST(LocalPolynomial, AFitToItClaimsTheScatterOfItsPoles) {
  const Resonator system;
  const auto u = binary(8000);
  double sum = 0.0, squares = 0.0, claimed = 0.0;
  constexpr int kRecords = 30;
  for (unsigned seed = 1; seed <= kRecords; ++seed) {
    LocalPolynomialSettings s = settings();
    s.to = 120.0;
    const auto y = with_noise(system.run(u), 0.05, seed);
    const RationalFit fit = fit_rational(local_polynomial(u, y, s, "a"), {2, 2, true}, "a");
    ASSERT_EQ(fit.poles.size(), 1u);
    sum += fit.poles[0].frequency / kRecords;
    squares += std::pow(fit.poles[0].frequency, 2) / kRecords;
    claimed += std::pow(fit.poles[0].frequency_deviation, 2) / kRecords;
  }
  const double scatter = std::sqrt((squares - sum * sum) * kRecords / (kRecords - 1.0));
  EXPECT_NEAR(sum, 60.0, 0.2);
  EXPECT_NEAR(std::sqrt(claimed) / scatter, 1.0, 0.4);
}

TEST(LocalPolynomial, RefusesAMultisineWhosePeriodIsNotGiven) {
  std::vector<double> u;
  for (int n = 0; n < 8000; ++n) {
    double sum = 0.0;
    for (int line = 20; line < 150; ++line) sum += std::cos(kTurn * line * n / kRate + line * line);
    u.push_back(sum);
  }
  EXPECT_EQ(fault_messages([&] { local_polynomial(u, u, settings(), "a.csv"); }),
            "has an input of which one line in 8 is excited: it is periodic; give its period\n");
}

TEST(LocalPolynomial, RefusesShortAndUnexcitedRecords) {
  const std::vector<double> nothing(1000, 2.0), little(20, 1.0);
  EXPECT_EQ(fault_messages([&] { local_polynomial(nothing, nothing, settings(), "a.csv"); }),
            "has an input without excitation\n");
  EXPECT_EQ(fault_messages([&] { local_polynomial(little, little, settings(), "a.csv"); }),
            "contains 20 samples; the local polynomial method requires at least 52\n");
}

}  // namespace
}  // namespace servomill::sim::responses::local_polynomial_test
