// One axis with everything that the NC has for it, in the order in which it is called.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "controllers/servo/backlash_compensation.h"
#include "controllers/servo/cascade.h"
#include "controllers/servo/current_loop.h"
#include "controllers/servo/friction_compensation.h"
#include "controllers/servo/position_feedback.h"
#include "controllers/servo/supervision.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::axis_test {
namespace {

constexpr double kTp = 0.2e-3;  // s, of the position and the velocity loop
constexpr double kTi = 0.1e-3;  // s

// Parts that are not given are absent.
struct AxisParams {
  CascadeParams cascade = {};
  PositionFeedbackParams feedback = {};
  BacklashCompensationParams backlash = {};
  FrictionCompensationParams friction = {};
  SupervisionParams supervision = {};
};

CascadeParams loops() {
  CascadeParams p;
  p.Kv = 250.0 / 3.0;
  p.kvf = p.kaf = 1.0;
  p.J = 17.2e-3;
  p.Kp = 3.44;
  p.Ki = p.Kp / 20e-3;
  p.r = 20 * mm / (2.0 * std::numbers::pi);
  p.Kt = 1.6;
  p.i_max = 50.0;
  p.Tv = kTp;
  return p;
}

// A winding on one inertia with Coulomb friction, steps of 10 us.
struct Motor {
  double i = 0.0, w = 0.0, phi = 0.0;  // A, rad/s, rad
  double tau_friction = 0.0;           // N m

  void advance(const CascadeParams& p, double u) {
    const double L = 4e-3, R = 0.6, Ke = 0.8, h = 10e-6;
    i += h * (u - R * i - Ke * w) / L;
    const double w_free = w + h * p.Kt * i / p.J, most = h * tau_friction / p.J;
    w = std::abs(w_free) <= most ? 0.0 : w_free - std::copysign(most, w_free);
    phi += h * w;
  }
};

// Two turns of a circle, one axis of it. Positions of the motor, one per position period.
std::vector<double> run(const AxisParams& axis, double tau_friction) {
  const CascadeParams& p = axis.cascade;
  const CurrentLoopParams current{.Kp = 14.0, .Ki = 7000.0, .u_max = 320.0, .Ti = kTi};
  const double R = 50 * mm, w_path = 2.0 * m_per_min / R;

  Motor motor{.phi = -R / p.r, .tau_friction = tau_friction};
  const double y_start = p.r * motor.phi;
  CascadeState s = standing_at(p, motor.phi, 0.0);
  CurrentLoopState u;
  PositionFeedbackState feedback = standing_at(axis.feedback, y_start, y_start);
  BacklashCompensationState backlash = standing_at(axis.backlash, y_start);
  FrictionCompensationState friction;
  SupervisionState supervision =
      standing_at(axis.supervision, {y_start, 0.0, y_start, y_start, y_start});

  std::vector<double> positions;
  const double end = 4.0 * std::numbers::pi / w_path;
  for (int n = 0; n * kTi < end; ++n) {
    const double t = n * kTi, q = -R * std::cos(w_path * t), dq = R * w_path * std::sin(w_path * t);
    if (n % 2 == 0) {
      const double y_motor = p.r * motor.phi, y_scale = y_motor;
      const double y = position_feedback(axis.feedback, feedback, y_motor, y_scale);
      const BacklashRamp ramp = backlash_compensation(axis.backlash, backlash, q);
      position_loop(p, s, q, y, dq, w_path * w_path * -q, ramp.rate);
      EXPECT_EQ(supervise(axis.supervision, supervision, {q, dq, y, y_motor, y_scale}),
                std::nullopt);
      positions.push_back(y_scale);
    }
    latch_current_command(s);
    if (n % 2 == 0) {
      velocity_loop(p, s, motor.phi, friction_compensation(axis.friction, friction, dq));
    }
    current_loop(current, u, s.i_cmd, motor.i);
    for (int k = 0; k < 10; ++k) motor.advance(p, u.u);
  }
  return positions;
}

TEST(Axis, DefaultsOfEveryFunctionLeaveThePlainCascadeBitForBit) {
  const std::vector<double> all_defaults = run({.cascade = loops()}, 1.43);
  // the plain cascade: nothing but the three loops
  const CascadeParams p = loops();
  const CurrentLoopParams current{.Kp = 14.0, .Ki = 7000.0, .u_max = 320.0, .Ti = kTi};
  const double R = 50 * mm, w_path = 2.0 * m_per_min / R;
  Motor motor{.phi = -R / p.r, .tau_friction = 1.43};
  CascadeState s{.phi = motor.phi};
  CurrentLoopState u;
  for (int n = 0; n < 20000; ++n) {
    const double t = n * kTi, q = -R * std::cos(w_path * t), dq = R * w_path * std::sin(w_path * t);
    if (n % 2 == 0) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(all_defaults[static_cast<std::size_t>(n / 2)]),
                std::bit_cast<std::uint64_t>(p.r * motor.phi));
      position_loop(p, s, q, p.r * motor.phi, dq, w_path * w_path * -q);
    }
    latch_current_command(s);
    if (n % 2 == 0) velocity_loop(p, s, motor.phi);
    current_loop(current, u, s.i_cmd, motor.i);
    for (int k = 0; k < 10; ++k) motor.advance(p, u.u);
  }
}

TEST(Axis, EverythingTogetherFollowsACircleWithinAMicrometre) {
  AxisParams axis{.cascade = loops()};
  axis.cascade.v_max = 0.7;
  axis.cascade.tau_max = 70.0;
  axis.cascade.di_max = 1e5;
  axis.cascade.filters.append(notch(900.0, 0.1, 0.5, kTp));
  axis.feedback = crossover_feedback(80.0, kTp);
  axis.friction.tau_plus = axis.friction.tau_minus = 1.43;
  axis.friction.Tv = kTp;
  axis.supervision.following_error = 0.1 * mm;
  axis.supervision.encoder_difference = 0.01 * mm;
  axis.supervision.Tp = kTp;

  const double R = 50 * mm, w_path = 2.0 * m_per_min / R;
  const auto greatest_error = [&](const std::vector<double>& positions) {
    double greatest = 0.0;
    for (std::size_t k = positions.size() / 2; k < positions.size(); ++k) {
      const double q = -R * std::cos(w_path * static_cast<double>(k) * kTp);
      greatest = std::max(greatest, std::abs(q - positions[k]));
    }
    return greatest;
  };
  EXPECT_LT(greatest_error(run(axis, 1.43)), 1 * um);
  axis.friction = {};
  EXPECT_GT(greatest_error(run(axis, 1.43)), 10 * um);
}

}  // namespace
}  // namespace servomill::controllers::axis_test
