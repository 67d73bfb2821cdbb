/// Friction of a guideway: Coulomb with Stribeck effect, in three forms. Viscous friction of both
/// directions alike belongs to the linear part of a drive (b_load, sigma_2 of the LuGre model);
/// what a direction has beyond that, to the force when sliding.
///
/// The formulas are templates: of a description p that has the members of FrictionParams, for one
/// lane or for eight (pack.h), and of its numbers T and truths M.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "plant/vocabulary/numbers.h"

namespace servomill::plant {

enum class FrictionKind : std::uint8_t {
  none,
  set_valued,   // F = g(v) sgn(v); at v = 0 any force within [-Fs_negative, Fs_positive]
  regularised,  // F = g(v) tanh(v / v0): never holds still, creeps under load
  lugre,        // bristles of deflection z: presliding, then as above
};

/// A quantity and its derivative by speed.
template <class T>
struct WithSlope {
  T value, slope;
};
using ForceSlope = WithSlope<double>;  // N, N s/m

/// Beyond this many vs the Stribeck term is below the last bit of Fc, beyond this many v0 tanh
/// is 1.
inline constexpr double kStribeckEnd = 6.5, kTanhEnd = 20.0;

/// Constant description of the friction of one axis. For a rotary axis read N m for N and so on.
/// The two directions may differ; *_positive resists motion in +x.
struct FrictionParams {
  FrictionKind kind = FrictionKind::none;
  double Fc_positive = 0.0, Fc_negative = 0.0;  // N, Coulomb force, >= 0
  double Fs_positive = 0.0,
         Fs_negative = 0.0;  // N, breakaway force; below Fc: friction rises with speed
  double b_positive = 0.0, b_negative = 0.0;  // N s/m, viscous friction beside b_load
  double vs = 1.0;                            // m/s, Stribeck velocity
  double v0 = 1.0;                            // m/s, of the regularisation
  double sigma0 = 0.0;                        // N/m, stiffness of the bristles
  double sigma1 = 0.0;                        // N s/m, their damping

  /// exp(-(v / vs)^2)
  WithSlope<double> stribeck(double v) const {
    const double q = v / vs;
    if (std::abs(q) > kStribeckEnd) return {0.0, 0.0};
    const double bump = std::exp(-q * q);
    return {bump, -2.0 * q / vs * bump};
  }
  /// tanh(v / v0)
  WithSlope<double> saturation(double v) const {
    const double q = v / v0;
    if (std::abs(q) > kTanhEnd) return {q > 0.0 ? 1.0 : -1.0, 0.0};
    const double T = std::tanh(q);
    return {T, (1.0 - T * T) / v0};
  }
  bool operator==(const FrictionParams&) const = default;
};

/// Magnitude of the friction force when sliding in one direction:
/// g(v) = Fc + (Fs - Fc) exp(-(v / vs)^2) + b |v|, |v| = v in the direction +. With a direction it
/// goes on smoothly beyond v = 0.
template <class P, class M, class T>
WithSlope<T> sliding(const P& p, const M& positive, const T& v) {
  const T Fc = select(positive, p.Fc_positive, p.Fc_negative);
  const T drop = select(positive, p.Fs_positive, p.Fs_negative) - Fc;
  const WithSlope<T> bump = p.stribeck(v);
  const T b = select(positive, p.b_positive, -p.b_negative);
  return {fma(b, v, fma(drop, bump.value, Fc)), fma(drop, bump.slope, b)};
}
template <class P, class M, class T>
T sliding_force(const P& p, const M& positive, const T& v) {
  return sliding(p, positive, v).value;
}

/// Regularised friction g(v) tanh(v / v0), against +v. With a direction it goes on smoothly beyond
/// v = 0 with the g of that direction.
template <class P, class M, class T>
WithSlope<T> regularised(const P& p, const M& positive, const T& v) {
  const WithSlope<T> g = sliding(p, positive, v), S = p.saturation(v);
  return {g.value * S.value, fma(g.slope, S.value, g.value * S.slope)};
}
template <class P, class T>
WithSlope<T> regularised(const P& p, const T& v) {
  return regularised(p, v >= T(0.0), v);
}
template <class P, class M, class T>
T regularised_force(const P& p, const M& positive, const T& v) {
  return regularised(p, positive, v).value;
}
template <class P, class T>
T regularised_force(const P& p, const T& v) {
  return regularised(p, v).value;
}

/// Least force when sliding, in either direction (N).
inline double least_force(const FrictionParams& f) {
  return std::min({f.Fc_positive, f.Fc_negative, f.Fs_positive, f.Fs_negative});
}

/// LuGre: dz/dt = v - sigma0 |v| z / g(v) (m/s). Canudas de Wit et al. 1995, equations (2) to (4).
/// With a direction it goes on smoothly beyond v = 0 with the |v| and the g of that direction.
template <class P, class M, class T>
T bristle_rate(const P& p, const M& positive, const T& v, const T& z) {
  return v - p.sigma0 * select(positive, v, -v) * z / sliding_force(p, positive, v);
}
template <class P, class T>
T bristle_rate(const P& p, const T& v, const T& z) {
  return bristle_rate(p, v >= T(0.0), v, z);
}

/// LuGre: F = sigma0 z + sigma1 dz/dt (N), against +v; sigma2 v is in b_load.
template <class P, class T>
T bristle_force(const P& p, const T& v, const T& z) {
  return p.sigma0 * z + p.sigma1 * bristle_rate(p, v, z);
}

}  // namespace servomill::plant
