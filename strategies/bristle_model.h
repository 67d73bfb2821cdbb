/// Friction force of an axis from its velocity: bristles of the LuGre model, advanced exactly for a
/// velocity that is constant during a period.
///
///     dz/dt = v - sigma0 |v| z / g(v),   F = sigma0 z + sigma1 dz/dt
///     g(v)  = Fc + (Fs - Fc) exp(-(v / vs)^2) + b |v|,   each by the direction of v
///
/// Only what an axis travels moves the bristles: at standstill they stay as they are.
/// Source: C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, A new model for control of
/// systems with friction, IEEE Trans. Automatic Control 40 (1995) 419-425, equations (2) to (4).
#pragma once

#include <cmath>

#include "strategies/identified_loops.h"

namespace servomill::strategies {

/// g(v), N.
inline double sliding_force(const BristleFriction& friction, double v) {
  const bool positive = v >= 0.0;
  const double Fc = positive ? friction.Fc_positive : friction.Fc_negative;
  const double Fs = positive ? friction.Fs_positive : friction.Fs_negative;
  const double b = positive ? friction.b_positive : friction.b_negative;
  const double q = v / friction.vs;
  return Fc + (Fs - Fc) * std::exp(-q * q) + b * std::abs(v);
}

/// Force against +v (N) after one period.
/// @param friction  with sigma0 > 0
/// @param z         m, deflection of the bristles; becomes that after the period
inline double advance_bristles(const BristleFriction& friction, double v, double period,
                               double& z) {
  const double g = sliding_force(friction, v);
  const double end = std::copysign(g / friction.sigma0, v);
  const double left = std::exp(-friction.sigma0 * std::abs(v) * period / g);
  const double before = z;
  z = end + left * (z - end);
  return friction.sigma0 * z + friction.sigma1 * (z - before) / period;
}

}  // namespace servomill::strategies
