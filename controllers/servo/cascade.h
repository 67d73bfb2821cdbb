/// Cascade of one axis: position P with feed-forward, velocity PI, current command. Three free
/// functions over their own parameters and state; each is called when its period is due.
///
///   q_cmd, y --position_loop--> v_cmd --velocity_loop--> i_next --latch_current_command--> i_cmd
///
/// Behind i_cmd the drive is a first-order lag, or a winding under the loop of current_loop.h.
#pragma once

#include <algorithm>
#include <limits>

#include "controllers/servo/filters.h"

namespace servomill::controllers {

/// A limit that never holds.
inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Constant description of the cascade of one axis (m, rad as for its drive).
struct CascadeParams {
  double Kv = 0.0;     // 1/s, position gain
  double kvf = 0.0;    // -, velocity feed-forward; 0 is lag mode, between 0 and 1 semi feed-forward
  double kaf = 0.0;    // -, acceleration feed-forward
  double Kp = 0.0;     // N m s/rad, velocity gain at the motor
  double Ki = 0.0;     // N m/rad per second, Kp / Tn; 0: no integral part
  double r = 1.0;      // m/rad, slide travel per motor angle
  double Kt = 1.0;     // N m/A
  double J = 0.0;      // kg m^2, inertia that the acceleration feed-forward assumes
  double i_max = 0.0;  // A
  double Tv = 0.0;     // s, velocity period
  double v_max = kNoLimit;    // m/s, of the velocity command
  double tau_max = kNoLimit;  // N m, of the motor; acts as a current of tau_max / Kt
  double di_max = kNoLimit;   // A/s, slew of the current command; limits the jerk of the axis
  FilterChain filters = {};   // of the current command, run once per velocity period
};

struct CascadeState {
  double v_cmd = 0.0;     // m/s, from the position loop
  double i_ff = 0.0;      // A, acceleration feed-forward
  double integral = 0.0;  // N m
  double phi = 0.0;       // rad, motor angle read last
  double i_next = 0.0;    // A, computed; acts from the next current period on
  double i_cmd = 0.0;     // A, acts now
  FilterState filters = {};
};

/// The same loops without their limits, for linear analysis.
inline CascadeParams without_limits(CascadeParams p) {
  p.i_max = p.v_max = p.tau_max = p.di_max = kNoLimit;
  return p;
}

/// Following error (m or rad) of an axis that stands and holds `i` (A): none with an integral part,
/// else what the proportional loops need, r Kt i / (Kp Kv).
inline double standing_error(const CascadeParams& p, double i) {
  return p.Ki > 0.0 || i == 0.0 ? 0.0 : p.r * p.Kt * i / (p.Kp * p.Kv);
}

/// State of a cascade that has held `i` (A) at the motor angle `phi` (rad) for long.
inline CascadeState standing_at(const CascadeParams& p, double phi, double i) {
  return {.v_cmd = p.Kv * standing_error(p, i),
          .i_ff = 0.0,
          .integral = p.Ki > 0.0 ? i * p.Kt : 0.0,
          .phi = phi,
          .i_next = i,
          .i_cmd = i,
          .filters = standing_at(p.filters, i)};
}

/// Position loop: v_cmd = Kv (q_cmd - y) + kvf dq_ff + v_add limited to +-v_max,
/// i_ff = kaf J ddq_ff / (r Kt). At constant speed y lags by (1 - kvf) v / Kv.
///
/// It has no integral that the velocity limit could wind up; the one behind it goes on, since the
/// velocity loop stays in command of a drive that moves at v_max.
/// @param y      position that the NC reads (m or rad)
/// @param v_add  velocity to add, m/s: backlash compensation
inline void position_loop(const CascadeParams& p, CascadeState& s, double q_cmd, double y,
                          double dq_ff, double ddq_ff, double v_add = 0.0) {
  s.v_cmd = std::clamp(p.Kv * (q_cmd - y) + p.kvf * dq_ff + v_add, -p.v_max, p.v_max);
  s.i_ff = p.kaf * p.J * ddq_ff / (p.r * p.Kt);
}

/// Velocity loop: e = v_cmd / r - dphi, i = (Kp e + I) / Kt + i_ff + tau_ff / Kt, then
///
///   limit to +-min(i_max, tau_max / Kt) -> filters -> slew by at most di_max Tv -> limit again
///
/// I gains Ki Tv e unless a limit holds it (anti-windup): the first one, the slew or the last one
/// (a filter may overshoot). The filters stand between the limits, so that they never hold more
/// than the drive can do, need no anti-windup of their own and are not seen by the gate: what they
/// change is no saturation. Speed is the difference of the motor angle over one period.
/// @param tau_ff   torque to add, N m: friction compensation
/// @param limited  whether something behind holds the drive back, too: the voltage
///                 (CurrentLoopState::limited); it holds the integral
inline void velocity_loop(const CascadeParams& p, CascadeState& s, double phi, double tau_ff = 0.0,
                          bool limited = false) {
  const double e = s.v_cmd / p.r - (phi - s.phi) / p.Tv;
  s.phi = phi;
  const double i_limit = std::min(p.i_max, p.tau_max / p.Kt);
  const double slew = p.di_max * p.Tv;

  const double i = (p.Kp * e + s.integral) / p.Kt + s.i_ff + tau_ff / p.Kt;
  const double i_limited = std::clamp(i, -i_limit, i_limit);
  const double i_filtered = advance(p.filters, s.filters, i_limited);
  const double i_slewed = std::clamp(i_filtered, s.i_next - slew, s.i_next + slew);
  s.i_next = std::clamp(i_slewed, -i_limit, i_limit);
  limited = limited || i_limited != i || s.i_next != i_filtered;
  if (!limited) s.integral += p.Ki * p.Tv * e;
}

/// The drive follows what the velocity loop computed before this instant, so that a command is one
/// current period old when it acts. Call it before velocity_loop within a tick.
inline void latch_current_command(CascadeState& s) { s.i_cmd = s.i_next; }

}  // namespace servomill::controllers
