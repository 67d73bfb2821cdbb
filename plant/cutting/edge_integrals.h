/// Integrals over angles of rotation that forces on edges consist of.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servomill::plant {

/// Integrals over phi of 1, sin, cos, sin^2, sin cos.
struct EdgeIntegrals {
  double one = 0.0, sine = 0.0, cosine = 0.0, sine_squared = 0.0, sine_cosine = 0.0;

  /// Adds the range [from, to] (rad), if it is one.
  void add(double from, double to) {
    if (!(to > from)) return;
    one += to - from;
    sine += std::cos(from) - std::cos(to);
    cosine += std::sin(to) - std::sin(from);
    sine_squared += 0.5 * (to - from) - 0.25 * (std::sin(2.0 * to) - std::sin(2.0 * from));
    sine_cosine += 0.25 * (std::cos(2.0 * from) - std::cos(2.0 * to));
  }

  /// Adds a weight times the second integrals from `from` on to phi, of functions that are zero
  /// outside of [from, to]: they grow linearly beyond `to`.
  void add_twice(double from, double to, double phi, double weight) {
    if (phi <= from) return;
    const double end = phi < to ? phi : to, d = end - from;
    const double s = std::sin(from), c = std::cos(from), s_end = std::sin(end),
                 c_end = std::cos(end);
    const double s2 = 2.0 * s * c, c2 = c * c - s * s;
    const double s2_end = 2.0 * s_end * c_end, c2_end = c_end * c_end - s_end * s_end;
    const double rest = phi - end;
    one += weight * (0.5 * d * d + rest * d);
    sine += weight * (c * d - (s_end - s) + rest * (c - c_end));
    cosine += weight * ((c - c_end) - s * d + rest * (s_end - s));
    sine_squared += weight * (0.25 * d * d + 0.125 * (c2_end - c2) + 0.25 * s2 * d +
                              rest * (0.5 * d - 0.25 * (s2_end - s2)));
    sine_cosine += weight * (0.25 * c2 * d - 0.125 * (s2_end - s2) + rest * 0.25 * (c2 - c2_end));
  }
};

/// A rotation of a tooth: its edge at the lower end of a slice turns from phi by dtheta.
struct EdgeRotation {
  double phi, dtheta;  // rad
};

/// Integrals over a rotation, mean over the helix of a slice, of functions that are zero outside of
/// [from, to]. Whole turns apart they are the same.
/// @param lag_span  rad, by which the upper end of the slice is behind the lower
inline EdgeIntegrals rotation_integrals(const EdgeRotation& rotation, double lag_span, double from,
                                        double to) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  constexpr double kMinLag = 1e-3;  // rad: an edge that lags less is straight
  EdgeIntegrals I;
  const double end = rotation.phi + rotation.dtheta, begin = rotation.phi - lag_span;
  const double first = std::ceil((begin - to) / kTurn);
  const double last = std::floor((end - from) / kTurn);
  for (double turn = first; turn <= last; ++turn) {
    const double shift = kTurn * turn;
    if (lag_span < kMinLag) {
      const double half = 0.5 * lag_span;
      I.add(std::max(rotation.phi - half - shift, from), std::min(end - half - shift, to));
      continue;
    }
    const double weight = 1.0 / lag_span;
    I.add_twice(from, to, end - shift, weight);
    I.add_twice(from, to, rotation.phi - shift, -weight);
    I.add_twice(from, to, end - lag_span - shift, -weight);
    I.add_twice(from, to, begin - shift, weight);
  }
  return I;
}

}  // namespace servomill::plant
