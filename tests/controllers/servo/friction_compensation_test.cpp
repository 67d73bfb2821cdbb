#include "controllers/servo/friction_compensation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::friction_compensation_test {
namespace {

constexpr double kRounding = 1e-13;  // N m, of some thousand factors at 1 N m
constexpr double kTv = 0.2e-3;       // s

FrictionCompensationParams two_sided() {
  FrictionCompensationParams p;
  p.tau_plus = 1.4;
  p.tau_minus = 1.1;
  p.v_switch = 1e-3;
  p.Tv = kTv;
  return p;
}

TEST(FrictionCompensation, AddsTheCoulombTorqueOfTheDirection) {
  const FrictionCompensationParams p = two_sided();
  FrictionCompensationState s;
  EXPECT_EQ(friction_compensation(p, s, 0.1), 1.4);
  EXPECT_EQ(friction_compensation(p, s, -0.1), -1.1);
}

TEST(FrictionCompensation, IsNothingBeforeTheFirstMotion) {
  FrictionCompensationParams p = two_sided();
  p.tau_pulse = 2.0;
  p.reversal_pulse_time = 10e-3;
  FrictionCompensationState s;
  EXPECT_EQ(friction_compensation(p, s, 0.0), 0.0);
  EXPECT_EQ(friction_compensation(p, s, 0.1), 1.4) << "the first motion is no reversal";
}

TEST(FrictionCompensation, TurnsOverWithTheSpeedUpToTheSwitch) {
  const FrictionCompensationParams p = two_sided();
  FrictionCompensationState s;
  friction_compensation(p, s, 1.0);
  for (const double share : {0.0, 0.1, 0.25, 0.5, 0.75, 0.999, 1.0, 1.001, 50.0}) {
    const double direction = std::max(-1.0, 1.0 - 2.0 * share);
    EXPECT_NEAR(friction_compensation(p, s, -share * p.v_switch),
                direction * (direction > 0.0 ? p.tau_plus : p.tau_minus), kRounding)
        << share;
  }
}

TEST(FrictionCompensation, SwitchesAtOnceWithoutADeadZone) {
  FrictionCompensationParams p = two_sided();
  p.v_switch = 0.0;
  FrictionCompensationState s;
  EXPECT_EQ(friction_compensation(p, s, 1e-300), 1.4);
  EXPECT_EQ(friction_compensation(p, s, -1e-300), -1.1);
  EXPECT_EQ(friction_compensation(p, s, 0.0), -1.1);
}

TEST(FrictionCompensation, HoldsAtStandstillWhatItHeld) {
  const FrictionCompensationParams p = two_sided();
  FrictionCompensationState s;
  for (const double v : {0.1, 0.01, 0.5e-3, 1e-9}) EXPECT_EQ(friction_compensation(p, s, v), 1.4);
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(friction_compensation(p, s, 0.0), 1.4);
  EXPECT_EQ(friction_compensation(p, s, 0.1), 1.4) << "on in the same direction: nothing happens";
}

TEST(FrictionCompensation, AnswersNoiseAtStandstillByItsShareOfTheSwitchOnly) {
  FrictionCompensationParams p = two_sided();
  p.tau_pulse = 2.0;
  p.reversal_pulse_time = 10e-3;
  FrictionCompensationState s;
  friction_compensation(p, s, 0.1);
  std::mt19937 dice(5);
  const double noise = 0.02 * p.v_switch;
  for (int k = 0; k < 10000; ++k) {
    const double v = noise * (static_cast<double>(dice()) / 2147483648.0 - 1.0);
    EXPECT_GE(friction_compensation(p, s, v), (1.0 - 2.0 * 0.02) * p.tau_plus);
  }
}

TEST(FrictionCompensation, TheSpikeFallsWithTime) {
  FrictionCompensationParams p = two_sided();
  p.v_switch = 0.0;
  p.tau_pulse = 2.0;
  p.reversal_pulse_time = 10e-3;
  FrictionCompensationState s;
  friction_compensation(p, s, 0.1);
  for (int k = 0; k < 500; ++k) {
    EXPECT_NEAR(friction_compensation(p, s, -0.1), -1.1 - 2.0 * std::exp(-k * kTv / 10e-3),
                kRounding);
  }
}

TEST(FrictionCompensation, TheSpikeFallsWithTheWayWhateverTheSpeed) {
  FrictionCompensationParams p = two_sided();
  p.v_switch = 0.0;
  p.tau_pulse = 2.0;
  p.reversal_pulse_distance = 0.1 * mm;
  std::mt19937 dice(6);
  FrictionCompensationState s;
  friction_compensation(p, s, -0.1);
  double way = 0.0;
  for (int k = 0; way < 1.0 * mm; ++k) {
    const double v = k % 7 == 3 ? 0.0 : 0.1 * static_cast<double>(dice()) / 4294967296.0;
    if (k > 0) way += v * kTv;
    if (k == 0) {
      EXPECT_EQ(friction_compensation(p, s, v), 1.4 + 2.0);
    } else {
      EXPECT_NEAR(friction_compensation(p, s, v), 1.4 + 2.0 * std::exp(-way / (0.1 * mm)),
                  kRounding);
    }
  }
}

TEST(FrictionCompensation, ANegativeSpikeTurnsTheTorqueOverAsBristlesDo) {
  // LuGre friction with Fs = Fc: F(s) = Fc (1 - 2 exp(-s sigma0 / Fc)) behind a reversal
  FrictionCompensationParams p = two_sided();
  p.v_switch = 0.0;
  p.tau_pulse = -(p.tau_plus + p.tau_minus);
  p.reversal_pulse_distance = 9.0 * um;
  FrictionCompensationState s;
  friction_compensation(p, s, 0.1);
  const double v = 1.0 * mm;
  for (int k = 0; k < 800; ++k) {
    const double share = std::exp(-k * v * kTv / p.reversal_pulse_distance);
    EXPECT_NEAR(friction_compensation(p, s, -v), -p.tau_minus + share * (p.tau_plus + p.tau_minus),
                kRounding);
  }
  for (int k = 0; k < 800; ++k) friction_compensation(p, s, -v);
  EXPECT_EQ(s.pulse, 0.0) << "spent as a positive one is";
}

TEST(FrictionCompensation, EachReversalHasOneSpike) {
  FrictionCompensationParams p = two_sided();
  p.tau_pulse = 2.0;
  p.reversal_pulse_time = 1e-3;
  FrictionCompensationState s;
  int spikes = 0;
  double before = 0.0;
  for (int k = 0; k < 40000; ++k) {  // 8 s of 1 Hz: the first rise is no reversal
    friction_compensation(p, s, 0.01 * std::sin(2.0 * std::numbers::pi * k * kTv));
    spikes += std::abs(s.pulse) > std::abs(before);
    before = s.pulse;
  }
  EXPECT_EQ(spikes, 15);
  EXPECT_EQ(s.pulse, 0.0) << "spent spikes are gone, they do not become denormal";
}

// One inertia with set-valued friction and the loops of DOMAIN.md 4.2 on an axis of a circle, R =
// 50 mm at 2 m/min. Greatest following error (m) around the quadrants once it repeats.
double quadrant(double tau_static, double tau_coulomb, const FrictionCompensationParams& friction) {
  CascadeParams p;
  p.Kv = 250.0 / 3.0;
  p.kvf = p.kaf = 1.0;
  p.J = 17.2e-3;
  p.Kp = 3.44;
  p.Ki = p.Kp / 20e-3;
  p.r = 20 * mm / (2.0 * std::numbers::pi);
  p.Kt = 1.6;
  p.i_max = 50.0;
  p.Tv = kTv;
  const double R = 50 * mm, w_path = 2.0 * m_per_min / R, period = 2.0 * std::numbers::pi / w_path;
  const int substeps = 20;
  const double h = kTv / substeps;

  CascadeState s;
  FrictionCompensationState state;
  double phi = -R / p.r, w = 0.0, greatest = 0.0;
  s.phi = phi;
  for (int k = 0; k * kTv < 1.9 * period; ++k) {
    const double a = w_path * k * kTv;
    const double q = -R * std::cos(a), dq = R * w_path * std::sin(a);
    const double ddq = R * w_path * w_path * std::cos(a);
    if (k * kTv > 0.9 * period) greatest = std::max(greatest, std::abs(q - p.r * phi));
    position_loop(p, s, q, p.r * phi, dq, ddq);
    velocity_loop(p, s, phi, friction_compensation(friction, state, dq));
    for (int n = 0; n < substeps; ++n) {
      const double tau = p.Kt * s.i_next;
      if (w == 0.0 && std::abs(tau) <= tau_static) continue;
      const double w_free = w + h * tau / p.J, most = h * tau_coulomb / p.J;
      w = std::abs(w_free) <= most ? 0.0 : w_free - std::copysign(most, w_free);
      phi += h * w;
    }
  }
  return greatest;
}

FrictionCompensationParams for_quadrants(double tau_coulomb) {
  FrictionCompensationParams p;
  p.tau_plus = p.tau_minus = tau_coulomb;
  p.Tv = kTv;
  return p;
}

TEST(FrictionCompensation, TakesMostOfTheGlitchAway) {
  const double tau = 1.43;  // N m, 450 N
  const double without = quadrant(tau, tau, for_quadrants(0.0));
  const double with = quadrant(tau, tau, for_quadrants(tau));
  const double r = 20 * mm / (2.0 * std::numbers::pi);
  EXPECT_LT(without, 2.0 * tau * r / (3.44 * 250.0 / 3.0)) << "upper bound of DOMAIN.md 9";
  EXPECT_GT(without, 10 * um);
  EXPECT_LT(with, 0.05 * without);
}

TEST(FrictionCompensation, TheSpikeTakesTheBreakawayAway) {
  const double tau = 1.43, tau_static = 1.78;
  FrictionCompensationParams p = for_quadrants(tau);
  const double coulomb = quadrant(tau_static, tau, p);
  p.tau_pulse = tau_static - tau;
  p.reversal_pulse_time = 1e-3;
  const double with_spike = quadrant(tau_static, tau, p);
  EXPECT_LT(with_spike, 0.5 * coulomb);
}

TEST(FrictionCompensation, TooMuchOfItIsWorseThanTheRightAmount) {
  const double tau = 1.43;
  const double right = quadrant(tau, tau, for_quadrants(tau));
  EXPECT_GT(quadrant(tau, tau, for_quadrants(1.3 * tau)), 2.0 * right);
  EXPECT_GT(quadrant(tau, tau, for_quadrants(0.7 * tau)), 2.0 * right);
}

}  // namespace
}  // namespace servomill::controllers::friction_compensation_test
