/// Inverses of loops with a closed form: exact for slow displacements, and their recursions.
#include "strategies/loop_inverse.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/strategies/known_loops.h"

namespace servomill::strategies::loop_inverse_test {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

PreviewTimes times_of(double lag) { return {0.0, 0.5 * kReach * lag, kReach * lag}; }

TEST(LoopInverse, FindsTheLag) {
  for (const double Kv : {40.0, 112.0}) {
    KnownLoop loop;
    loop.Kv = Kv;
    EXPECT_NEAR(lag_of(response_of(loop)), 1.0 / Kv + loop.delay, 2e-3 / Kv);
  }
}

// Share of a displacement that the loop does not make, at a share of its corner. Looking 1/Kv ahead
// leaves (f/corner)^2 / 2 and more.
TEST(LoopInverse, MakesTheLoopFollow) {
  for (const double Kv : {40.0, 73.0, 112.0}) {
    KnownLoop loop;
    loop.Kv = Kv;
    const LoopResponse known = response_of(loop);
    const double lag = lag_of(known), corner = 1.0 / (kTwoPi * lag);
    const PreviewTimes times = times_of(lag);
    const LoopInverse H = inverse_of(known, times, kModelPeriod);
    EXPECT_NEAR(H.weight[0] + H.weight[1] + H.weight[2], 1.0, 1e-12);
    const double alpha = 1.0 / H.share - 1.0;
    EXPECT_NEAR(H.weight[1] * times[1] + H.weight[2] * times[2] - alpha * kModelPeriod, lag, 1e-12);
    EXPECT_GT(H.share, 0.0);
    EXPECT_LE(H.share, 1.0);
    const auto left = [&](double f) {
      const double w = kTwoPi * f;
      return std::abs(1.0 - loop.P(w) * response(H, times, kModelPeriod, w));
    };
    const auto left_by_lead = [&](double f) {
      return std::abs(1.0 - loop.P(kTwoPi * f) * std::polar(1.0, kTwoPi * f / Kv));
    };
    EXPECT_LT(left(0.02 * corner), 1e-4) << Kv;
    EXPECT_LT(left(0.1 * corner), 5e-4) << Kv;
    EXPECT_LT(left(0.3 * corner), 3e-3) << Kv;
    EXPECT_GT(left_by_lead(0.1 * corner), 3e-3) << Kv;
    EXPECT_GT(left_by_lead(0.3 * corner), 10.0 * left(0.3 * corner)) << Kv;
  }
}

TEST(ForceInverse, IsThatOfTheClosedForm) {
  const KnownLoop loop;
  const ForceInverse C = force_inverse_of(response_of(loop), kModelPeriod);
  const double corner = loop.Kv / kTwoPi;
  for (const double share : {0.01, 0.1, 0.3, 0.5}) {
    const double w = kTwoPi * share * corner;
    const Complex wanted = loop.force_over_P(w);
    EXPECT_LT(std::abs(response(C, kModelPeriod, w) - wanted), 0.02 * std::abs(wanted)) << share;
  }
}

TEST(ForceInverse, HasTheResponseOfItsRecursion) {
  const KnownLoop loop;
  const ForceInverse C = force_inverse_of(response_of(loop), kModelPeriod);
  const double w = kTwoPi * 7.0;
  ForceInverseState state;
  double d = 0.0;
  Complex turn;
  for (int n = 0; n < 30'000; ++n) {
    turn = std::polar(1.0, w * kModelPeriod * n);
    d = state.advance(C, turn.imag());
  }
  const Complex wanted = response(C, kModelPeriod, w);
  EXPECT_NEAR(d, (wanted * turn).imag(), 1e-9 * std::abs(wanted));
}

// Without an integral part a force displaces an axis for good.
TEST(ForceInverse, TakesAwayTheStaticDisplacementOfAProportionalLoop) {
  LoopResponse known = response_of({});
  const double compliance = 1e-8;  // m/N
  for (std::size_t k = 0; k < known.f.size(); ++k) {
    known.force[k] = compliance * -known.displacement[k];
  }
  const ForceInverse C = force_inverse_of(known, kModelPeriod);
  EXPECT_NEAR(std::abs(response(C, kModelPeriod, 1e-3)), compliance, 1e-3 * compliance);
}

}  // namespace
}  // namespace servomill::strategies::loop_inverse_test
