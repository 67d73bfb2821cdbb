/// Temperature compensation: the setpoint of the linear axes is offset by what temperatures
/// displace the tip by, as controls do.
///
///     d(Q, T) = -J_l^-1 e(Q, T),   e = sum over temperatures of (T_k - T_ref) e_k(Q)
///
/// T are readings of sensors, whose errors e_k a regression has found (servomill identify-heat), or
/// what the thermal network of the known machine computes from speed and currents. A filter of
/// first order takes noise off them. Tool axis: what temperatures tilt is not corrected. Source of
/// the form: SINUMERIK Extended Functions, K3 (2013), temperature compensation: an offset and a
/// slope over the position of the axis, per temperature.
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry thermal_entry();

}  // namespace servomill::strategies
