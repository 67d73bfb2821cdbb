/// Position, velocity and acceleration of the joints from scale readings: a tracking filter for a
/// motion of constant acceleration, whose three poles lie together.
///
///     x_n|n-1 = Phi x_n-1,   Phi = [1 T T^2/2; 0 1 T; 0 0 1]
///     x_n     = x_n|n-1 + l (y_n - x_n|n-1[0])
///     q = exp(-w T):  l = (1 - q^3,  1.5 (1 - q)^2 (1 + q) / T,  (1 - q)^3 / T^2)
///
/// It follows a constant acceleration without any lag; a jerk j leaves 3 j / w^2 of velocity. White
/// noise of the readings passes with the factors of response().
/// Source: E. Brookner, Tracking and Kalman Filtering Made Easy, 1998, section 2.6 (critically
/// damped g-h-k filter, 1 - q^3, 1.5 (1 - q^2)(1 - q), 0.5 (1 - q)^3).
#pragma once

#include <array>
#include <cmath>
#include <complex>

#include "plant/vocabulary/axes.h"

namespace servomill::strategies {

struct ObserverGains {
  double T = 0.0;                                             // s, between two readings
  double position = 1.0, velocity = 0.0, acceleration = 0.0;  // 1, 1/s, 1/s^2
};

/// @param w  rad/s, of the three poles
inline ObserverGains observer_gains(double w, double T) {
  const double q = std::exp(-w * T), rest = -std::expm1(-w * T);
  return {T, 1.0 - q * q * q, 1.5 * rest * rest * (1.0 + q) / T, rest * rest * rest / (T * T)};
}

struct ObservedMotion {
  Joints position = Joints::Zero(), velocity = Joints::Zero(), acceleration = Joints::Zero();

  /// Has been standing there.
  void settle(const Joints& y) {
    position = y;
    velocity.setZero();
    acceleration.setZero();
  }
  void advance(const ObserverGains& l, const Joints& y) {
    position += l.T * velocity + 0.5 * l.T * l.T * acceleration;
    velocity += l.T * acceleration;
    const Joints e = y - position;
    position += l.position * e;
    velocity += l.velocity * e;
    acceleration += l.acceleration * e;
  }
  /// Position after a time (s) in which the acceleration stays.
  Joints ahead(double t) const { return position + t * velocity + 0.5 * t * t * acceleration; }
};

/// Position, velocity and acceleration over the reading at w (rad/s):
/// with z = exp(j w T), from the recursion above,
///     e = (z - 1)^3 / ((z - 1)^3 + ...) y  solved as acceleration <- e, velocity, position.
inline std::array<std::complex<double>, 3> observer_response(const ObserverGains& l, double w) {
  const std::complex<double> z = std::polar(1.0, w * l.T), back = 1.0 / z;
  // of e = 1; u = z^-1 x are the states before
  const std::complex<double> a = l.acceleration / (1.0 - back);
  const std::complex<double> v = (l.velocity + l.T * back * a) / (1.0 - back);
  const std::complex<double> p =
      (l.position + back * (l.T * v + 0.5 * l.T * l.T * a)) / (1.0 - back);
  const std::complex<double> y = 1.0 + back * (p + l.T * v + 0.5 * l.T * l.T * a);
  return {p / y, v / y, a / y};
}

}  // namespace servomill::strategies
