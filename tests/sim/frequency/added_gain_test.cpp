// Margins of position loops with an added gain.
#include "sim/frequency/added_gain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/frequency/tuning.h"
#include "sim/model/machine.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::frequency::added_gain_test {
namespace {

constexpr double kPi = std::numbers::pi;

// Kv exp(-s T) / s
Curve with_delay(double Kv, double T) {
  const ResponseAt L = [=](double f) {
    const std::complex<double> s(0.0, 2.0 * kPi * f);
    return Kv * std::exp(-s * T) / s;
  };
  return curve_of(L, logarithmic(0.1, 2000.0, 2000));
}

// Phase margin 90 deg - K T, gain margin pi / (2 K T): 45 deg binds, K = pi / (4 T).
TEST(AddedGain, OfAPureDelayIsThatOfTheClosedForm) {
  const double Kv = 40.0, T = 4 * ms;
  const double C = largest_added_gain(with_delay(Kv, T), Kv, Kv, {});
  EXPECT_NEAR(Kv + C, kPi / (4.0 * T), 2e-3 * Kv);
  // 12 dB bind: K = pi / (2 T) / 4
  EXPECT_NEAR(Kv + largest_added_gain(with_delay(Kv, T), Kv, Kv, {.gain = 4.0}), kPi / (8.0 * T),
              2e-3 * Kv);
  EXPECT_EQ(largest_added_gain(with_delay(Kv, 30 * ms), Kv, Kv, {}), 0.0)
      << "Kv itself is too high";
}

// An integral costs atan(C / (Kv + C) / (w Ti)) at the crossover.
TEST(AddedGain, WithAnIntegralHasLessPhase) {
  const double Kv = 40.0, C = 60.0, T = 4 * ms, Ti = 80 * ms;
  const Margins with = margins_with(with_delay(Kv, T), Kv, {C, Ti});
  const double w = 2.0 * kPi * with.crossover;
  EXPECT_NEAR(with.phase, 0.5 * kPi - w * T - std::atan(C / (Kv + C) / (w * Ti)), 1e-4);
}

// With the integral that the run will have, the gain that is found has the margin, 1 % more has
// not.
TEST(AddedGain, KeepsItsMarginsWithAnIntegral) {
  const double Kv = 40.0, T = 4 * ms;
  for (const WantedMargins& wanted :
       {WantedMargins{.Ti = 20 * ms}, WantedMargins{.reset_ratio = 8.0}}) {
    const Curve open = with_delay(Kv, T);
    const double C = largest_added_gain(open, Kv, 83.0, wanted);
    ASSERT_GT(C, 10.0);
    const auto phase = [&](double gain) {
      const double Ti = wanted.Ti > 0.0 ? wanted.Ti : wanted.reset_ratio / (83.0 + gain);
      return margins_with(open, Kv, {gain, Ti}).phase;
    };
    EXPECT_GE(phase(C), 45 * deg);
    EXPECT_LT(phase(C + 0.01 * Kv), 45 * deg);
  }
}

// A proportional gain is a larger Kv, on the exact multirate model of every axis.
TEST(AddedGain, ThatIsProportionalIsALargerKv) {
  const model::MachineSettings machine =
      small_scenario("M2\n", "[[case]]\nname = \"one\"\n").machine;
  for (int joint = 0; joint < kLinearJoints; ++joint) {
    const Gains gains = gains_of(machine, joint);
    const Curve open = open_position_loop(machine, joint, 1);
    Gains higher = gains;
    higher.Kv += 50.0;
    const Margins exact = assess(with_gains(machine, joint, higher), joint, 1).position;
    const Margins found = margins_with(open, gains.Kv, {50.0, 0.0});
    EXPECT_NEAR(found.phase, exact.phase, 2e-3);
    EXPECT_NEAR(found.gain, exact.gain, 5e-3 * exact.gain);
    const double C = largest_added_gain(open, gains.Kv, gains.Kv, {});
    higher.Kv = gains.Kv + 0.99 * C;
    TuneSettings wanted;
    wanted.phase_margin = 45 * deg;
    wanted.gain_margin = 2.0;
    wanted.overshoot = 10.0;
    EXPECT_TRUE(keeps(assess(with_gains(machine, joint, higher), joint, 1), wanted));
    higher.Kv = gains.Kv + 1.02 * C;
    EXPECT_FALSE(keeps(assess(with_gains(machine, joint, higher), joint, 1), wanted));
  }
}

}  // namespace
}  // namespace servomill::sim::frequency::added_gain_test
