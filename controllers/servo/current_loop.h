/// Current loop of one axis, discrete: the drive's current follows its command through the winding.
#pragma once

#include <algorithm>

namespace servomill::controllers {

/// Constant description of the current loop of one axis.
struct CurrentLoopParams {
  double Kp = 0.0;     // V/A
  double Ki = 0.0;     // V/(A s), Kp / Tn; 0: no integral part
  double u_max = 0.0;  // V, half the intermediate-circuit voltage or what the inverter leaves of it
  double Ti = 0.0;     // s, current period
};

struct CurrentLoopState {
  double integral = 0.0;  // V
  double u = 0.0;         // V, holds until the next current period
  bool limited = false;   // whether u_max cut it
};

/// Command (A) that holds a current for long, and the state that goes with it.
struct StandingCurrent {
  double i_cmd = 0.0;
  CurrentLoopState state;
};

/// Holding i (A) under the voltage u = R i: without an integral part the command is ahead by u /
/// Kp.
inline StandingCurrent standing_at(const CurrentLoopParams& p, double i, double u) {
  if (p.Ki > 0.0) return {i, {.integral = u, .u = u}};
  return {i + u / p.Kp, {.integral = 0.0, .u = u}};
}

/// PI with a limited voltage: e = i_cmd - i, u = Kp e + I limited to +-u_max; then I gains Ki Ti e
/// unless the limit holds it (anti-windup). A limit that is reached but does not cut is none.
/// @param i_cmd  A, from the velocity loop
/// @param i      A, torque-forming current at this instant
inline void current_loop(const CurrentLoopParams& p, CurrentLoopState& s, double i_cmd, double i) {
  const double e = i_cmd - i;
  const double u = p.Kp * e + s.integral;
  s.u = std::clamp(u, -p.u_max, p.u_max);
  s.limited = s.u != u;
  if (!s.limited) s.integral += p.Ki * p.Ti * e;
}

}  // namespace servomill::controllers
