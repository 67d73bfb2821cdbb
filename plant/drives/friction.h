/// Friction of a guideway: Coulomb with Stribeck effect, in three forms. Viscous friction belongs
/// to the linear part of a drive (b_load, sigma_2 of the LuGre model).
#pragma once

#include <cmath>
#include <cstdint>

namespace servomill::plant {

enum class FrictionKind : std::uint8_t {
  none,
  set_valued,   // F = g(v) sgn(v); at v = 0 any force within [-Fs_negative, Fs_positive]
  regularised,  // F = g(v) tanh(v / v0): never holds still, creeps under load
  lugre,        // bristles of deflection z: presliding, then as above
};

/// Constant description of the friction of one axis. For a rotary axis read N m for N and so on.
/// The two directions may differ; *_positive resists motion in +x.
struct FrictionParams {
  FrictionKind kind = FrictionKind::none;
  double Fc_positive = 0.0, Fc_negative = 0.0;  // N, Coulomb force, >= 0
  double Fs_positive = 0.0, Fs_negative = 0.0;  // N, breakaway force, >= Fc
  double vs = 1.0;                              // m/s, Stribeck velocity
  double v0 = 1.0;                              // m/s, of the regularisation
  double sigma0 = 0.0;                          // N/m, stiffness of the bristles
  double sigma1 = 0.0;                          // N s/m, their damping

  bool operator==(const FrictionParams&) const = default;
};

/// Beyond this many vs the Stribeck term is below the last bit of Fc, beyond this many v0 tanh
/// is 1.
inline constexpr double kStribeckEnd = 6.5, kTanhEnd = 20.0;

/// A force (N) and its derivative by speed (N s/m).
struct ForceSlope {
  double value, slope;
};

/// Magnitude of the friction force when sliding in one direction, a smooth and even function of v:
/// g(v) = Fc + (Fs - Fc) exp(-(v / vs)^2).
inline ForceSlope sliding(const FrictionParams& p, bool positive, double v) {
  const double Fc = positive ? p.Fc_positive : p.Fc_negative;
  const double Fs = positive ? p.Fs_positive : p.Fs_negative;
  const double q = v / p.vs;
  if (std::abs(q) > kStribeckEnd) return {Fc, 0.0};
  const double bump = (Fs - Fc) * std::exp(-q * q);
  return {Fc + bump, -2.0 * q / p.vs * bump};
}
inline double sliding_force(const FrictionParams& p, bool positive, double v) {
  return sliding(p, positive, v).value;
}

/// Regularised friction g(v) tanh(v / v0), against +v. With a direction it goes on smoothly beyond
/// v = 0 with the g of that direction.
inline double regularised_force(const FrictionParams& p, bool positive, double v) {
  return sliding_force(p, positive, v) * std::tanh(v / p.v0);
}
inline ForceSlope regularised(const FrictionParams& p, double v) {
  const ForceSlope g = sliding(p, v >= 0.0, v);
  const double q = v / p.v0;
  if (std::abs(q) > kTanhEnd) return q > 0.0 ? g : ForceSlope{-g.value, -g.slope};
  const double T = std::tanh(q);
  return {g.value * T, g.slope * T + g.value * (1.0 - T * T) / p.v0};
}
inline double regularised_force(const FrictionParams& p, double v) {
  return regularised(p, v).value;
}

/// LuGre: dz/dt = v - sigma0 |v| z / g(v) (m/s). Canudas de Wit et al. 1995, equations (2) to (4).
/// With a direction it goes on smoothly beyond v = 0 with the |v| and the g of that direction.
inline double bristle_rate(const FrictionParams& p, bool positive, double v, double z) {
  return v - p.sigma0 * (positive ? v : -v) * z / sliding_force(p, positive, v);
}
inline double bristle_rate(const FrictionParams& p, double v, double z) {
  return bristle_rate(p, v >= 0.0, v, z);
}

/// LuGre: F = sigma0 z + sigma1 dz/dt (N), against +v; sigma2 v is in b_load.
inline double bristle_force(const FrictionParams& p, double v, double z) {
  return p.sigma0 * z + p.sigma1 * bristle_rate(p, v, z);
}

}  // namespace servomill::plant
