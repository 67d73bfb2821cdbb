/// Current loop of one axis, discrete: the drive's current follows its command through the winding.
#pragma once

#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/numbers.h"

namespace servomill::controllers {

/// Constant description of the current loop of one axis.
struct CurrentLoopParams {
  double Kp = 0.0;     // V/A
  double Ki = 0.0;     // V/(A s), Kp / Tn; 0: no integral part
  double u_max = 0.0;  // V, half the intermediate-circuit voltage or what the inverter leaves of it
  double Ti = 0.0;     // s, current period
};

/// @tparam Number  double for one axis, LaneArray for eight
template <class Number>
struct CurrentLoopStateOf {
  Number integral{};  // V
  Number u{};         // V, holds until the next current period
  Number excess{};    // V, by which u_max cut it

  bool limited() const { return excess != 0.0; }
};
using CurrentLoopState = CurrentLoopStateOf<double>;
using CurrentLoopLanesState = CurrentLoopStateOf<LaneArray>;

/// Coefficients of the loop.
template <class Number>
struct CurrentLoopGainsOf {
  Number Kp{}, Ki_Ti{}, u_max{};  // V/A: Kp, Ki Ti; V
};
using CurrentLoopGains = CurrentLoopGainsOf<double>;
using CurrentLoopLanes = CurrentLoopGainsOf<LaneArray>;

inline CurrentLoopGains gains_of(const CurrentLoopParams& p) {
  return {p.Kp, p.Ki * p.Ti, p.u_max};
}

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
template <class Gains, class State, class Number>
void current_loop(const Gains& g, State& s, Number i_cmd, Number i) {
  const Number u_max = value<Number>(g.u_max), integral = value<Number>(s.integral);
  const Number e = i_cmd - i;
  const Number u = value<Number>(g.Kp) * e + integral;
  const Number u_limited = limited_to(-u_max, u_max, u);
  put(s.u, u_limited);
  put(s.excess, u - u_limited);
  put(s.integral, select(u_limited != u, integral, integral + value<Number>(g.Ki_Ti) * e));
}
inline void current_loop(const CurrentLoopParams& p, CurrentLoopState& s, double i_cmd, double i) {
  current_loop(gains_of(p), s, i_cmd, i);
}

}  // namespace servomill::controllers
