/// Friction compensation of the NC: the torque that keeps a drive moving, and the one that gets it
/// going again after a reversal.
#pragma once

#include "controllers/servo/cascade.h"

namespace servomill::controllers {

/// Constant description for one axis. Model of the NC, apart from the plant's friction.
struct FrictionCompensationParams {
  double tau_plus = 0.0;   // N m, >= 0, at the motor while moving in +
  double tau_minus = 0.0;  // N m, >= 0, against it while moving in -
  double v_switch = 0.0;   // m/s, >= 0, commanded speed at which the torque has turned over
  double tau_pulse = 0.0;  // N m, on top after a reversal; < 0: less torque at first
  double reversal_pulse_time = kNoLimit;  // s, the pulse falls to 1/e within it
  double reversal_pulse_distance =
      kNoLimit;     // m, the same over the way; with tau_pulse one of both is set
  double Tv = 0.0;  // s, velocity period

  bool compensates() const { return tau_plus > 0.0 || tau_minus > 0.0 || tau_pulse != 0.0; }
};

struct FrictionCompensationState {
  double direction = 0.0;  // -, -1 ... 1; 0 before the first motion
  double pulse = 0.0;      // N m, with its sign
};

/// Torque to add in the velocity loop (N m), called once per velocity period:
///
///   v > 0:  direction = max(direction, min(1, 2 v / v_switch - 1))
///   v < 0:  direction = min(direction, max(-1, 2 v / v_switch + 1))                            (1)
///   v = 0:  direction stays
///   tau = direction * (direction > 0 ? tau_plus : tau_minus) + pulse                           (2)
///   pulse = +-tau_pulse where direction changes its sign, then times exp(-Tv/T - |v| Tv/d)     (3)
///
/// At standstill the torque stays as it was: friction at rest goes on holding what it held, so that
/// taking the torque away would push a standing axis by the whole Coulomb torque and the velocity
/// loop would have to make it good. (1) is a play in the speed: noise of the command below v_switch
/// moves the torque by its share of v_switch at most, and v = 0 says the same again and again.
/// An axis that has never moved has direction 0: its first motion is no reversal and has no pulse.
///
/// At a quadrant of a circle (radius R, path speed v_path) the command passes zero with the slope
/// v_path^2 / R: (1) takes v_switch R / v_path^2 to turn over. The axis has to stop, bend the
/// friction over its presliding way (some um: sigma0 in LuGre) and break away, so that real
/// controls add a pulse for the difference of static and Coulomb friction and for what comes too
/// late; its best height grows with the acceleration at the reversal and levels off. A negative
/// pulse lets the torque turn over as the bristles do: -(tau_plus + tau_minus) over
/// reversal_pulse_distance = (Fc+ + Fc-) / (2 sigma0) is the presliding curve of LuGre friction
/// with Fs = Fc.
/// @param v  commanded speed, m/s: the fed-forward one with kvf = 1; in lag mode, where the axis
///           reverses 1/Kv later, CascadeState::v_cmd
/// Source: Heidenhain MP2610 ... MP2620 (digital axes: in the speed controller) and MP711/MP712
/// (height of the pulse, way over which it is given out); their curves are not published, (1) to
/// (3) are a model.
double friction_compensation(const FrictionCompensationParams& p, FrictionCompensationState& s,
                             double v);

}  // namespace servomill::controllers
