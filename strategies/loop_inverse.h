/// Inverse of a position loop for a displacement that is known ahead along the motion, and for a
/// friction force.
///
/// With P, minus the position over the virtual displacement (identified_loops.h), the axis is
/// displaced by w(t) if
///
///     d = -H w,   P H = 1,   H(z) = sum_k h_k exp(j w t_k) / (1 + alpha (1 - z^-1))            (1)
///
/// is fed back. The wanted displacement is evaluated where the machine will be at the times t_k, so
/// that H may look ahead, as the inverse of a loop with a lag must. Its pole is that of the reset
/// of the velocity loop, which 1/P has for s^3 and beyond: 1/P = 1 + s/Kv (1 + J s^2 / (Kp s + Ki))
/// without delays. h and alpha are the linear least squares of
///
///     P sum_k h_k exp(j w t_k) - alpha (1 - z^-1) = 1,   sum_k h_k = 1,  weighted by 1/w (2)
///
/// up to kBand of the loop's corner 1/(2 pi lag), so that slow displacements, which are the large
/// ones, are exact. A friction force F (against +x) displaces the axis by -G F, and feeding back
///
///     d = -C F,   C = G / P (3)
///
/// takes that away; C is fitted in the same way by (c0 + c1 s + c2 s^2) / (1 + alpha s),
/// s = 1 - z^-1, behind a low-pass of kSmooth.
/// Sources: M. Tomizuka, Zero phase error tracking algorithm for digital control, ASME J. Dyn. Sys.
/// Meas. Control 109 (1987) 65-68 (feeding a loop by its inverse with preview); E. C. Levy, Complex
/// curve fitting, IRE Trans. Automatic Control 4 (1959) 37-43 (the least squares).
#pragma once

#include <array>

#include "strategies/identified_loops.h"

namespace servomill::strategies {

inline constexpr std::size_t kPreviews = 3;
inline constexpr double kReach = 1.5;    // of the lag, between first and last preview
inline constexpr double kBand = 0.5;     // of the corner
inline constexpr double kSmooth = 1e-3;  // s

using PreviewTimes = std::array<double, kPreviews>;  // s, from 0, evenly spaced

/// H of (1).
struct LoopInverse {
  std::array<double, kPreviews> weight = {1.0, 0.0, 0.0};  // h_k
  double share = 1.0;  // 1 / (1 + alpha), of the difference that one period closes
};

/// C of (3) as k0 + k1 (1 - z^-1) + k2 / (1 + alpha (1 - z^-1)), in m/N.
struct ForceInverse {
  double k0 = 0.0, k1 = 0.0, k2 = 0.0;
  double share = 1.0;   // of that pole
  double smooth = 1.0;  // the same of the low-pass
};

/// State of a ForceInverse in one run; what it gives for a force, period by period.
struct ForceInverseState {
  double smooth = 0.0, slow = 0.0;  // N
  double advance(const ForceInverse& C, double F) {
    const double change = C.smooth * (F - smooth);
    smooth += change;
    slow += C.share * (smooth - slow);
    return C.k0 * smooth + C.k1 * change + C.k2 * slow;
  }
};

/// Lag of slow displacements (s).
double lag_of(const LoopResponse& loop);

/// @param period  s, model period
LoopInverse inverse_of(const LoopResponse& loop, const PreviewTimes& times, double period);
ForceInverse force_inverse_of(const LoopResponse& loop, double period);

/// H and C at w (rad/s).
std::complex<double> response(const LoopInverse& H, const PreviewTimes& times, double period,
                              double w);
std::complex<double> response(const ForceInverse& C, double period, double w);

}  // namespace servomill::strategies
