#include "controllers/servo/filters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace servomill::controllers::filters_test {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;
constexpr double kT = 0.2e-3;  // s
constexpr double kRounding =
    1e-11;  // of a gain, coefficients rounded to 1e-16 over the (w0 T)^2 of 25 Hz
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr Complex kI = {0.0, 1.0};

struct Dice {
  std::mt19937 bits{7};
  double uniform() { return static_cast<double>(bits()) / 4294967296.0; }
  double log_uniform(double low, double high) { return low * std::pow(high / low, uniform()); }
};

// A filter and the prototype H(p), p = s / w0, that it stands for.
struct Design {
  Biquad filter;
  double f;  // Hz, where both agree
  Complex (*prototype)(Complex p, double a, double b);
  double a = 0.0, b = 0.0;

  Complex ideal(double f_any) const { return prototype(kI * (f_any / f), a, b); }
};

// One of each kind, its frequency within two decades below `f_max` (Hz).
std::vector<Design> random_designs(Dice& dice, double f_max) {
  const auto f = [&] { return dice.log_uniform(1e-2 * f_max, f_max); };
  const double f1 = f(), f2 = f(), f3 = f(), f_zero = f(), f_pole = f();
  const double zn = dice.log_uniform(1e-3, 1.0), zd = dice.log_uniform(0.05, 2.0);
  const double zl = dice.log_uniform(0.05, 2.0), f4 = std::sqrt(f_zero * f_pole);
  return {
      {notch(f1, zn, zd, kT), f1,
       [](Complex p, double a, double b) {
         return (p * p + 2.0 * a * p + 1.0) / (p * p + 2.0 * b * p + 1.0);
       },
       zn, zd},
      {low_pass(f2, kT), f2, [](Complex p, double, double) { return 1.0 / (p + 1.0); }},
      {low_pass(f3, zl, kT), f3,
       [](Complex p, double a, double) { return 1.0 / (p * p + 2.0 * a * p + 1.0); }, zl},
      {lead_lag(f_zero, f_pole, kT), f4,
       [](Complex p, double a, double b) { return (1.0 + a * p) / (1.0 + b * p); }, f4 / f_zero,
       f4 / f_pole},
  };
}

// H(e^(j 2 pi f T)) from the impulse response of what really runs.
Complex measured(const Biquad& section, double f) {
  FilterChain chain;
  chain.append(section);
  FilterState state;
  Complex H = 0.0;
  for (int k = 0; k < 200000; ++k) {
    const double h = advance(chain, state, k == 0 ? 1.0 : 0.0);
    H += h * std::polar(1.0, -2.0 * kPi * f * kT * k);
    if (k > 10 && std::abs(state.z[0]) + std::abs(state.z[1]) < 1e-16) break;
  }
  return H;
}

TEST(Filters, ExistBelowHalfTheSamplingRateOnly) {
  static_assert(nyquist_frequency(0.2e-3) == 2500.0);
  static_assert(can_filter(2499.9, 0.2e-3) && !can_filter(2500.0, 0.2e-3));
  static_assert(can_filter(1e-6, 0.2e-3) && !can_filter(0.0, 0.2e-3) && !can_filter(-1.0, 0.2e-3));
  static_assert(!can_filter(std::numeric_limits<double>::quiet_NaN(), 0.2e-3));
}

TEST(Filters, EqualTheirPrototypeAtTheDesignFrequency) {
  Dice dice;
  for (int run = 0; run < 300; ++run) {
    for (const Design& d : random_designs(dice, 0.999 * nyquist_frequency(kT))) {
      EXPECT_LT(std::abs(response(d.filter, 2.0 * kPi * d.f * kT) - d.ideal(d.f)), kRounding)
          << "run " << run << ", " << d.f << " Hz";
    }
  }
}

TEST(Filters, FollowTheWarpedPrototypeElsewhere) {
  Dice dice;
  for (int run = 0; run < 10; ++run) {
    for (const Design& d : random_designs(dice, 0.9 * nyquist_frequency(kT))) {
      const double f = nyquist_frequency(kT) * dice.uniform();
      const double warped = d.f * std::tan(kPi * f * kT) / std::tan(kPi * d.f * kT);
      EXPECT_LT(std::abs(response(d.filter, 2.0 * kPi * f * kT) - d.ideal(warped)), kRounding);
      EXPECT_LT(std::abs(measured(d.filter, f) - d.ideal(warped)), 10.0 * kRounding)
          << "run " << run << ", design " << d.f << " Hz at " << f << " Hz";
    }
  }
}

TEST(Filters, ApproachTheirPrototypeWithTheSquareOfThePeriod) {
  const double f0 = 200.0, f = 90.0;  // Hz
  const auto error = [&](double T) {
    const Complex p = kI * (f / f0);
    return std::abs(response(low_pass(f0, 0.5, T), 2.0 * kPi * f * T) - 1.0 / (p * p + p + 1.0));
  };
  EXPECT_NEAR(std::log2(error(2e-4) / error(1e-4)), 2.0, 0.02);
}

TEST(Filters, HaveGainOneAtStandstill) {
  Dice dice;
  for (int run = 0; run < 300; ++run) {
    for (const Design& d : random_designs(dice, 0.999 * nyquist_frequency(kT))) {
      const Biquad& c = d.filter;
      const double sizes = std::abs(c.b0) + std::abs(c.b1) + std::abs(c.b2) + std::abs(c.a1) + 2.0;
      EXPECT_NEAR(c.b0 + c.b1 + c.b2, 1.0 + c.a1 + c.a2, kEpsilon * sizes) << d.f;
    }
  }
}

// Both roots of z^2 + a1 z + a2 lie within the unit circle: |a2| < 1, |a1| < 1 + a2.
TEST(Filters, AreStableForEveryAdmissibleParameter) {
  Dice dice;
  for (int run = 0; run < 3000; ++run) {
    const double f = dice.log_uniform(1e-4, 0.9999) * nyquist_frequency(kT);
    const double f2 = dice.log_uniform(1e-4, 0.9999) * nyquist_frequency(kT);
    const double zn = dice.log_uniform(1e-6, 10.0), zd = dice.log_uniform(1e-4, 10.0);
    for (const Biquad& c :
         {notch(f, zn, zd, kT), low_pass(f, kT), low_pass(f, zd, kT), lead_lag(f, f2, kT)}) {
      ASSERT_LT(std::abs(c.a2), 1.0) << f << " Hz, damping " << zd;
      ASSERT_LT(std::abs(c.a1), 1.0 + c.a2) << f << " Hz, damping " << zd;
    }
  }
}

TEST(Notch, TakesItsFrequencyDownToTheRatioOfTheDampings) {
  const double f0 = 123.0;  // Hz
  EXPECT_NEAR(std::abs(response(notch(f0, 0.05, 0.5, kT), 2.0 * kPi * f0 * kT)), 0.1, kRounding);
  EXPECT_LT(std::abs(response(notch(f0, 0.0, 0.5, kT), 2.0 * kPi * f0 * kT)), kRounding);
}

// At 123 Hz and 5 kHz the warping moves the edges of the notch by less than 1 %.
TEST(Notch, IsAboutTwiceTheDampingWide) {
  const double f0 = 123.0, zeta = 0.1;  // Hz, -
  const Biquad c = notch(f0, 0.0, zeta, kT);
  const double low = f0 * (std::sqrt(1.0 + zeta * zeta) - zeta), high = f0 * f0 / low;
  EXPECT_NEAR(high - low, 2.0 * zeta * f0, 1e-9);
  for (const double f : {low, high}) {
    EXPECT_NEAR(std::abs(response(c, 2.0 * kPi * f * kT)), std::sqrt(0.5), 0.01);
  }
}

TEST(LeadLag, TurnsThePhaseMostBetweenItsFrequencies) {
  const double f_zero = 50.0, f_pole = 200.0;  // Hz: sin(phase) = (4 - 1) / (4 + 1)
  const Biquad c = lead_lag(f_zero, f_pole, kT);
  EXPECT_NEAR(std::arg(response(c, 2.0 * kPi * 100.0 * kT)), std::asin(3.0 / 5.0), kRounding);
  EXPECT_LT(std::arg(response(c, 2.0 * kPi * 90.0 * kT)), std::asin(3.0 / 5.0));
  EXPECT_LT(std::arg(response(c, 2.0 * kPi * 110.0 * kT)), std::asin(3.0 / 5.0));
}

TEST(FilterChain, PassesEverythingOnWhenEmpty) {
  const FilterChain none;
  FilterState state;
  for (const double u : {1.0 / 3.0, -0.0, 1e300, 5e-324}) EXPECT_EQ(advance(none, state, u), u);
}

TEST(FilterChain, MultipliesTheResponsesOfItsSections) {
  FilterChain chain;
  chain.append(notch(120.0, 0.05, 0.5, kT));
  chain.append(notch(400.0, 0.02, 0.3, kT));
  chain.append(lead_lag(300.0, 200.0, kT));
  chain.append(low_pass(800.0, 0.7, kT));
  const double w_T = 2.0 * kPi * 150.0 * kT;
  Complex product = 1.0, H = 0.0;
  for (const Biquad& c : chain.sections) product *= response(c, w_T);
  FilterState state;
  for (int k = 0; k < 2000; ++k) {
    H += advance(chain, state, k == 0 ? 1.0 : 0.0) * std::polar(1.0, -w_T * k);
  }
  EXPECT_LT(std::abs(response(chain, w_T) - product), kRounding);
  EXPECT_LT(std::abs(H - product), kRounding);
}

TEST(FilterChain, StaysWhereItWasSettled) {
  FilterChain chain;
  chain.append(notch(120.0, 0.05, 0.5, kT));
  chain.append(low_pass(800.0, kT));
  FilterState state = standing_at(chain, -7.3);
  for (int k = 0; k < 100; ++k) EXPECT_NEAR(advance(chain, state, -7.3), -7.3, kRounding);
}

}  // namespace
}  // namespace servomill::controllers::filters_test
