/// Errors of a ball screw in a position measured at its motor: lead error and thermal growth.
#pragma once

#include <string>
#include <vector>

#include "plant/geometry/error_function.h"

namespace servomill::plant {

/// Growth of a screw that is held axially at one end and warms up evenly along its length:
///
///     e(x, t) = alpha dT(t) (x - x_fixed),   dT(t) = dT_end (1 - exp(-t / tau))
///
/// Neglected: second order in alpha dT (10 nm at 1 m and 10 K), a temperature that varies along the
/// screw, a screw stretched between two fixed ends (its growth shows only once it exceeds the
/// stretch). The scale of an axis that has one is not affected.
struct ScrewGrowth {
  double alpha = 11.5e-6;  // 1/K, of steel
  double x_fixed = 0.0;    // m, slide position at which the nut is at the axial bearing
  double dT_end = 0.0;     // K, rise of temperature in the end, negative when it cools
  double tau = 0.0;        // s, 0: warm from the start

  double rise(double t) const;  ///< dT(t) in K for t >= 0; 0 before
  bool operator==(const ScrewGrowth&) const = default;
};

/// Travel of the slide less what the motor angle and the nominal lead promise:
///
///     e(x, t) = lead(x) + growth(x, t),   X_s = x + delta,   r phi = X_s - e(X_s, t)
///
/// where X_s is the travel of the nut, x that of the slide and delta (m) the deflection between
/// them. A positive e takes the slide further than the motor's encoder says: an axis that closes
/// its loop at the motor then stands at x + e. A drive that carries delta instead of phi is
/// simulated with the nominal r, and e enters the motor's reading alone. That neglects
/// the ratio r / (1 - de/dx) in the torques, a change of |de/dx| (1e-5 to 1e-4 for a rolled or warm
/// screw) of inertia, friction and stiffness as the motor feels them, and the velocity de/dt of a
/// growing screw (nm/s).
struct ScrewError {
  ErrorFunction lead;  // m, of X_s
  ScrewGrowth growth;

  /// e(x, t) in m; x in m, t in s.
  double at(double x, double t) const;
  /// de/dx at x, t (1).
  double slope(double x, double t) const;
  bool is_zero() const;
  bool operator==(const ScrewError&) const = default;
};

/// phi = (X_s - e(X_s, t)) / r in rad; X_s = x + delta in m, r in m/rad. For an error of zero this
/// is X_s / r, bit for bit.
double motor_angle(const ScrewError& error, double r, double X_s, double t);

/// Rules of physics that the values break, each as "KEY RULE" in SI. Empty for a possible screw.
std::vector<std::string> implausible(const ScrewGrowth& growth);

}  // namespace servomill::plant
