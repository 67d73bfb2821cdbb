// Limits and filters between the position loop and the current: their effect, and all that they
// leave alone. The drive is one inertia, exact under a held current.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "controllers/servo/cascade.h"
#include "controllers/servo/current_loop.h"

namespace servomill::controllers::cascade_limits_test {
namespace {

CascadeParams axis() {
  CascadeParams p;
  p.Kv = 80.0;
  p.Kp = 3.0;
  p.Ki = 150.0;
  p.r = 0.003;
  p.Kt = 1.5;
  p.J = 0.015;
  p.i_max = 50.0;
  p.Tv = 0.2e-3;
  return p;
}

struct Rotor {
  double phi = 0.0, w = 0.0;  // rad, rad/s

  void advance(const CascadeParams& p, double i, double tau_load) {
    const double dw = (p.Kt * i - tau_load) / p.J;
    phi += p.Tv * (w + 0.5 * p.Tv * dw);
    w += p.Tv * dw;
  }
};

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

TEST(CascadeLimits, WithoutThemTheLoopsAreTheSameBitForBit) {
  const CascadeParams p = axis();
  std::mt19937 dice(3);
  const auto any = [&] { return static_cast<double>(dice()) / 2147483648.0 - 1.0; };
  CascadeState s;
  double phi = 0.0, v_cmd = 0.0, i_ff = 0.0, integral = 0.0, i_next = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double q = 1e-3 * any(), y = 1e-3 * any(), dq = 0.5 * any(), ddq = 20.0 * any();
    const double phi_now = phi + 0.02 * any();
    position_loop(p, s, q, y, dq, ddq);
    velocity_loop(p, s, phi_now);

    v_cmd = p.Kv * (q - y) + p.kvf * dq;
    i_ff = p.kaf * p.J / (p.r * p.Kt) * ddq;
    const double e = v_cmd * (1.0 / p.r) - (phi_now - phi) * (1.0 / p.Tv);
    phi = phi_now;
    const double i = (p.Kp * e + integral) * (1.0 / p.Kt) + i_ff;
    i_next = std::clamp(i, -p.i_max, p.i_max);
    if (i_next == i) integral += p.Ki * p.Tv * e;
    ASSERT_EQ(bits(s.i_next), bits(i_next)) << "period " << k;
    ASSERT_EQ(bits(s.integral), bits(integral)) << "period " << k;
  }
}

TEST(CascadeLimits, TheVelocityCommandStopsAtItsLimit) {
  CascadeParams p = axis();
  p.v_max = 0.5;
  for (const double sign : {1.0, -1.0}) {
    CascadeState s;
    position_loop(p, s, sign * 0.499 / p.Kv, 0.0, 0.0, 0.0);
    EXPECT_EQ(s.v_cmd, p.Kv * (sign * 0.499 / p.Kv));
    position_loop(p, s, sign * 0.501 / p.Kv, 0.0, 0.0, 0.0);
    EXPECT_EQ(s.v_cmd, sign * 0.5);
  }
}

TEST(CascadeLimits, TheTorqueLimitIsACurrentLimit) {
  CascadeParams p = axis();
  p.tau_max = 30.0;                       // 20 A
  for (const double w : {9.99, 10.01}) {  // rad/s; 10 rad/s demand 30 N m
    CascadeState s;
    s.v_cmd = w * p.r;
    velocity_loop(p, s, 0.0);
    EXPECT_EQ(s.i_next == 20.0, w > 10.0) << s.i_next;
    EXPECT_EQ(s.integral > 0.0, w < 10.0);
  }
}

TEST(CascadeLimits, TheCurrentCommandChangesByNoMoreThanItsSlew) {
  CascadeParams p = axis();
  p.di_max = 5000.0;  // 1 A per period
  CascadeState s;
  s.v_cmd = 1.7 / 3.0 * p.Kt * p.r;  // demands 1.7 A
  velocity_loop(p, s, 0.0);
  EXPECT_DOUBLE_EQ(s.i_next, 1.0);
  EXPECT_EQ(s.integral, 0.0);
  velocity_loop(p, s, 0.0);
  EXPECT_DOUBLE_EQ(s.i_next, 1.7);
  EXPECT_GT(s.integral, 0.0);
}

TEST(CascadeLimits, TheSlewBoundsTheJerkOfTheAxis) {
  CascadeParams p = axis();
  p.di_max = 1000.0;
  const double ddw_max = p.Kt * p.di_max / p.J;  // rad/s^3
  CascadeState s;
  Rotor rotor;
  s.v_cmd = 0.06;
  double i_before = 0.0, largest = 0.0;
  for (int k = 0; k < 2000; ++k) {
    velocity_loop(p, s, rotor.phi);
    largest = std::max(largest, std::abs(s.i_next - i_before) / p.Tv * p.Kt / p.J);
    i_before = s.i_next;
    rotor.advance(p, s.i_next, 0.0);
  }
  EXPECT_NEAR(largest, ddw_max, 1e-9 * ddw_max);  // rounding
}

// A step of the speed that runs into the limit. Highest speed over the commanded one.
double overshoot(const CascadeParams& p, bool gate) {
  const double w_cmd = 100.0;  // rad/s
  CascadeState s;
  s.v_cmd = w_cmd * p.r;
  Rotor rotor;
  double highest = 0.0;
  for (int k = 0; k < 5000; ++k) {
    const double before = s.integral;
    const double e = w_cmd - (rotor.phi - s.phi) / p.Tv;
    velocity_loop(p, s, rotor.phi);
    if (!gate) s.integral = before + p.Ki * p.Tv * e;
    rotor.advance(p, s.i_next, 2.0);
    highest = std::max(highest, rotor.w);
  }
  EXPECT_NEAR(rotor.w, w_cmd, 1e-6) << "the load is not carried in the end";
  return highest / w_cmd - 1.0;
}

// PI on an inertia overshoots even when nothing is limited (its zero); the limit may not add to it.
TEST(AntiWindup, RecoversFromTheCurrentLimitWithoutOvershoot) {
  CascadeParams p = axis();
  p.i_max = 20.0;
  EXPECT_LT(overshoot(p, true), 0.02);
  EXPECT_GT(overshoot(p, false), 0.25);
}

TEST(AntiWindup, RecoversFromTheTorqueLimitWithoutOvershoot) {
  CascadeParams p = axis();
  p.tau_max = 30.0;
  EXPECT_LT(overshoot(p, true), 0.02);
  EXPECT_GT(overshoot(p, false), 0.25);
}

TEST(AntiWindup, RecoversFromTheSlewLimitWithoutOvershoot) {
  CascadeParams p = axis();
  p.i_max = 20.0;
  p.di_max = 5000.0;
  EXPECT_LT(overshoot(p, true), 0.02);
  EXPECT_GT(overshoot(p, false), 0.25);
}

TEST(AntiWindup, IsNotTroubledByFiltersBetweenTheLimits) {
  CascadeParams p = axis();
  p.i_max = 20.0;
  p.filters.append(notch(300.0, 0.05, 0.5, p.Tv));
  p.filters.append(low_pass(1000.0, 0.7, p.Tv));
  EXPECT_LT(overshoot(p, true), 0.02);
  EXPECT_GT(overshoot(p, false), 0.25);
}

// A step of the speed to 90 % of what the voltage can drive, with a current limit that never holds:
// less overshoot than without any limit, where the PI alone makes 14 %.
TEST(AntiWindup, RecoversFromTheVoltageLimitBehindIt) {
  CascadeParams p = axis();
  p.i_max = 500.0;
  const double L = 4e-3, R = 0.6, Ke = 0.9, w_cmd = 100.0;  // H, ohm, V s/rad, rad/s
  const auto over = [&](double u_max, bool tell) {
    const CurrentLoopParams current{.Kp = 14.0, .Ki = 7000.0, .u_max = u_max, .Ti = p.Tv};
    CascadeState s;
    s.v_cmd = w_cmd * p.r;
    CurrentLoopState u;
    double i = 0.0, w = 0.0, phi = 0.0, highest = 0.0;
    const double h = p.Tv / 20;
    for (int k = 0; k < 5000; ++k) {
      latch_current_command(s);
      velocity_loop(p, s, phi, 0.0, tell && u.limited());
      current_loop(current, u, s.i_cmd, i);
      for (int n = 0; n < 20; ++n) {
        i += h * (u.u - R * i - Ke * w) / L;
        w += h * p.Kt * i / p.J;
        phi += h * w;
      }
      highest = std::max(highest, w);
    }
    EXPECT_NEAR(w, w_cmd, 1e-3);
    return highest / w_cmd - 1.0;
  };
  const double with_gate = over(100.0, true), without = over(100.0, false);
  const double unlimited = over(kNoLimit, false);
  EXPECT_LT(with_gate, unlimited);
  EXPECT_GT(without, 1.5 * unlimited);
}

// The velocity loop stays in command at v_max: its integral has to carry the load there.
TEST(AntiWindup, ALimitedVelocityIsKeptUnderLoadAndLeftWithoutOvershoot) {
  CascadeParams p = axis();
  p.Kv = 40.0;
  p.v_max = 0.2;
  CascadeState s;
  Rotor rotor;
  double farthest = 0.0;
  const double q_cmd = 0.1, tau_load = 5.0;  // m, N m
  for (int k = 0; k < 10000; ++k) {
    position_loop(p, s, q_cmd, p.r * rotor.phi, 0.0, 0.0);
    velocity_loop(p, s, rotor.phi);
    rotor.advance(p, s.i_next, tau_load);
    farthest = std::max(farthest, p.r * rotor.phi);
    if (k == 1500) {
      EXPECT_EQ(s.v_cmd, p.v_max);
      EXPECT_NEAR(p.r * rotor.w, p.v_max, 1e-6);  // m/s, rest of the transient
    }
  }
  EXPECT_NEAR(p.r * rotor.phi, q_cmd, 1e-9);
  EXPECT_LT(farthest, q_cmd + 50e-6);
}

TEST(CurrentFilters, CannotOvershootTheLimit) {
  CascadeParams p = axis();
  p.Ki = 0.0;
  p.filters.append(low_pass(200.0, 0.2, p.Tv));  // overshoots by half of a step
  CascadeState s;
  s.v_cmd = 1.0;
  double highest = 0.0;
  FilterState alone;
  double unlimited = 0.0;
  for (int k = 0; k < 100; ++k) {
    velocity_loop(p, s, 0.0);
    highest = std::max(highest, s.i_next);
    unlimited = std::max(unlimited, advance(p.filters, alone, p.i_max));
  }
  EXPECT_GT(unlimited, 1.4 * p.i_max);
  EXPECT_EQ(highest, p.i_max);
}

TEST(CurrentFilters, LeaveTheIntegralAloneAsLongAsNothingIsLimited) {
  CascadeParams p = axis(), plain = axis();
  p.filters.append(low_pass(50.0, 0.7, p.Tv));
  CascadeState s, t;
  s.v_cmd = t.v_cmd = 0.01;
  for (int k = 0; k < 50; ++k) {
    velocity_loop(p, s, 0.0);
    velocity_loop(plain, t, 0.0);
    EXPECT_EQ(s.integral, t.integral);
    EXPECT_NE(s.i_next, t.i_next);
  }
}

TEST(CurrentFilters, HoldWhatTheDriveHeld) {
  CascadeParams p = axis();
  p.filters.append(notch(120.0, 0.05, 0.5, p.Tv));
  CascadeState s = standing_at(p, 3.0, 12.0);
  for (int k = 0; k < 100; ++k) velocity_loop(p, s, 3.0);
  EXPECT_NEAR(s.i_next, 12.0, 1e-11);  // A, rounding of the filter
}

// Two inertias with a spring. The delay of the loop turns its phase by more than 90 deg at the
// resonance, 780 Hz, which therefore rings; with a notch there the same gain is quiet.
TEST(CurrentFilters, ANotchQuietensAResonance) {
  struct TwoMass {
    double phi = 0.0, w = 0.0, theta = 0.0, u = 0.0;  // motor, load
  };
  const double J_load = 0.010, k = 8.0e4, c = 0.5;  // kg m^2, N m/rad, N m s/rad
  CascadeParams p = axis();
  p.J = 0.005;
  p.Kp = 6.0;
  p.Ki = 0.0;
  const double f_r = std::sqrt(k * (1.0 / J_load + 1.0 / p.J)) / (2.0 * std::numbers::pi);
  const auto rest_after = [&](double seconds) {
    TwoMass x;
    CascadeState s;
    s.v_cmd = 0.003;  // 1 rad/s, held
    const int steps = 200;
    const double h = p.Tv / steps;
    for (int n = 0; n < static_cast<int>(seconds / p.Tv); ++n) {
      latch_current_command(s);
      velocity_loop(p, s, x.phi);
      for (int m = 0; m < steps; ++m) {
        const double spring = k * (x.phi - x.theta) + c * (x.w - x.u);
        x.w += h * (p.Kt * s.i_cmd - spring) / p.J;
        x.u += h * spring / J_load;
        x.phi += h * x.w;
        x.theta += h * x.u;
      }
    }
    return std::abs(x.w - x.u);
  };
  EXPECT_GT(rest_after(0.2), 1.0);  // rad/s: it rings at the limit
  p.filters.append(notch(f_r, 0.05, 0.7, p.Tv));
  EXPECT_LT(rest_after(0.2), 1e-6);
}

}  // namespace
}  // namespace servomill::controllers::cascade_limits_test
