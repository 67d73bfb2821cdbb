/// Cascade of one axis: position P with feed-forward, velocity PI, current command. Three free
/// functions over their own parameters and state; each is called when its period is due.
#pragma once

#include <algorithm>

namespace servomill::controllers {

/// Constant description of the cascade of one axis (m, rad as for its drive).
struct CascadeParams {
  double Kv = 0.0;     // 1/s, position gain
  double kvf = 0.0;    // -, velocity feed-forward; 0 is lag mode
  double kaf = 0.0;    // -, acceleration feed-forward
  double Kp = 0.0;     // N m s/rad, velocity gain at the motor
  double Ki = 0.0;     // N m/rad per second, Kp / Tn; 0: no integral part
  double r = 1.0;      // m/rad, slide travel per motor angle
  double Kt = 1.0;     // N m/A
  double J = 0.0;      // kg m^2, inertia that the acceleration feed-forward assumes
  double i_max = 0.0;  // A
  double Tv = 0.0;     // s, velocity period
};

struct CascadeState {
  double v_cmd = 0.0;     // m/s, from the position loop
  double i_ff = 0.0;      // A, acceleration feed-forward
  double integral = 0.0;  // N m
  double phi = 0.0;       // rad, motor angle read last
  double i_next = 0.0;    // A, computed; acts from the next current period on
  double i_cmd = 0.0;     // A, acts now
};

/// Position loop: v_cmd = Kv (q_cmd - y) + kvf dq_ff,  i_ff = kaf J ddq_ff / (r Kt).
/// @param y  position that the NC reads (m or rad)
inline void position_loop(const CascadeParams& p, CascadeState& s, double q_cmd, double y,
                          double dq_ff, double ddq_ff) {
  s.v_cmd = p.Kv * (q_cmd - y) + p.kvf * dq_ff;
  s.i_ff = p.kaf * p.J * ddq_ff / (p.r * p.Kt);
}

/// Velocity loop: e = v_cmd / r - dphi, i = (Kp e + I) / Kt + i_ff limited to +-i_max; I gains
/// Ki Tv e unless the limit holds it (anti-windup). Speed is the difference of the motor angle over
/// one period.
inline void velocity_loop(const CascadeParams& p, CascadeState& s, double phi) {
  const double e = s.v_cmd / p.r - (phi - s.phi) / p.Tv;
  s.phi = phi;
  const double i = (p.Kp * e + s.integral) / p.Kt + s.i_ff;
  s.i_next = std::clamp(i, -p.i_max, p.i_max);
  if (s.i_next == i) s.integral += p.Ki * p.Tv * e;
}

/// Current loop: the drive follows what the velocity loop computed before this instant, so that a
/// command is one current period old when it acts. Call it before velocity_loop within a tick.
inline void current_loop(CascadeState& s) { s.i_cmd = s.i_next; }

}  // namespace servomill::controllers
