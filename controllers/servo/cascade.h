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
#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/numbers.h"

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

/// @tparam Number  double for one axis, LaneArray for eight
template <class Number, class Filters>
struct CascadeStateOf {
  Number v_cmd{};     // m/s, from the position loop
  Number i_ff{};      // A, acceleration feed-forward
  Number integral{};  // N m
  Number phi{};       // rad, motor angle read last
  Number w{};         // rad/s, motor speed as it was read last
  Number e{};         // rad/s, what it lacked
  Number i_next{};    // A, computed; acts from the next current period on
  Number i_cmd{};     // A, acts now
  Filters filters{};
};
using CascadeState = CascadeStateOf<double, FilterState>;
using CascadeLanesState = CascadeStateOf<LaneArray, FilterLanesState>;

/// Coefficients of the loops: CascadeParams without divisions.
template <class Number, class Filters>
struct CascadeGainsOf {
  Number Kv{}, kvf{}, v_max{};         // 1/s, -, m/s
  Number i_per_a{};                    // A s^2/m: kaf J / (r Kt)
  Number per_r{}, per_Tv{}, per_Kt{};  // 1/r, 1/Tv, 1/Kt
  Number Kp{}, Ki_Tv{};                // N m s/rad: Kp, Ki Tv
  Number i_max{}, di_max{};            // A: least of i_max and tau_max / Kt; slew in one period
  Filters filters{};
};
using CascadeGains = CascadeGainsOf<double, FilterChain>;
using CascadeLanes = CascadeGainsOf<LaneArray, FilterLanes>;

inline CascadeGains gains_of(const CascadeParams& p) {
  return {p.Kv,
          p.kvf,
          p.v_max,
          p.kaf * p.J / (p.r * p.Kt),
          1.0 / p.r,
          1.0 / p.Tv,
          1.0 / p.Kt,
          p.Kp,
          p.Ki * p.Tv,
          std::min(p.i_max, p.tau_max / p.Kt),
          p.di_max * p.Tv,
          p.filters};
}

/// Makes one of eight axes what `gains` and `state` say.
void set_lane(CascadeLanes& lanes, std::size_t lane, const CascadeGains& gains);
void set_lane(CascadeLanesState& lanes, std::size_t lane, const CascadeState& state);

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
  CascadeState s;
  s.v_cmd = p.Kv * standing_error(p, i);
  s.integral = p.Ki > 0.0 ? i * p.Kt : 0.0;
  s.phi = phi;
  s.i_next = s.i_cmd = i;
  s.filters = standing_at(p.filters, i);
  return s;
}

/// Position loop: v_cmd = Kv (q_cmd - y) + kvf dq_ff + v_add limited to +-v_max,
/// i_ff = kaf J ddq_ff / (r Kt). At constant speed y lags by (1 - kvf) v / Kv.
///
/// It has no integral that the velocity limit could wind up; the one behind it goes on, since the
/// velocity loop stays in command of a drive that moves at v_max.
/// @param y      position that the NC reads (m or rad)
/// @param v_add  velocity to add, m/s: backlash compensation
template <class Gains, class State, class Number>
void position_loop(const Gains& g, State& s, Number q_cmd, Number y, Number dq_ff, Number ddq_ff,
                   Number v_add) {
  const Number v_max = value<Number>(g.v_max);
  const Number v = value<Number>(g.Kv) * (q_cmd - y) + value<Number>(g.kvf) * dq_ff + v_add;
  put(s.v_cmd, limited_to(-v_max, v_max, v));
  put(s.i_ff, value<Number>(g.i_per_a) * ddq_ff);
}
inline void position_loop(const CascadeParams& p, CascadeState& s, double q_cmd, double y,
                          double dq_ff, double ddq_ff, double v_add = 0.0) {
  position_loop(gains_of(p), s, q_cmd, y, dq_ff, ddq_ff, v_add);
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
/// @param v_add    m/s, to add to the velocity command: a measurement's injection
template <class Gains, class State, class Number, class Mask>
void velocity_loop(const Gains& g, State& s, Number phi, Number tau_ff, Mask limited,
                   Number v_add) {
  const Number w = (phi - value<Number>(s.phi)) * value<Number>(g.per_Tv);
  const Number e = (value<Number>(s.v_cmd) + v_add) * value<Number>(g.per_r) - w;
  put(s.phi, phi);
  put(s.w, w);
  put(s.e, e);
  const Number i_max = value<Number>(g.i_max), di_max = value<Number>(g.di_max);
  const Number integral = value<Number>(s.integral), i_last = value<Number>(s.i_next);

  const Number i = (value<Number>(g.Kp) * e + integral + tau_ff) * value<Number>(g.per_Kt) +
                   value<Number>(s.i_ff);
  const Number i_limited = limited_to(-i_max, i_max, i);
  const Number i_filtered = advance(g.filters, s.filters, i_limited);
  const Number i_slewed = limited_to(i_last - di_max, i_last + di_max, i_filtered);
  const Number i_next = limited_to(-i_max, i_max, i_slewed);
  put(s.i_next, i_next);
  limited = limited | (i_limited != i) | (i_next != i_filtered);
  put(s.integral, select(limited, integral, integral + value<Number>(g.Ki_Tv) * e));
}
inline void velocity_loop(const CascadeParams& p, CascadeState& s, double phi, double tau_ff = 0.0,
                          bool limited = false) {
  velocity_loop(gains_of(p), s, phi, tau_ff, limited, 0.0);
}

/// The drive follows what the velocity loop computed before this instant, so that a command is one
/// current period old when it acts. Call it before velocity_loop within a tick.
template <class State>
void latch_current_command(State& s) {
  s.i_cmd = s.i_next;
}

}  // namespace servomill::controllers
