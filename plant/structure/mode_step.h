/// Step of one mode of the structure under the acceleration of a slide.
#pragma once

#include "plant/structure/inertial_compliance.h"

namespace servomill::plant {

/// State of a mode. A rigid mode has eta = -a.
struct ModeState {
  double eta = 0.0;   // m/s^2 (rad/s^2 of a rotary joint)
  double deta = 0.0;  // m/s^3
};

/// Motion of a slide over a step of length h, from its velocity and position at both ends.
struct SlideMotion {
  double dv = 0.0;  // m/s, v(h) - v(0)
  double dx = 0.0;  // m, x(h) - x(0) - h v(0)
};

/// Exact step of length h for the piecewise linear acceleration that has the velocity and the
/// position of the slide at both ends (the position is then a cubic Hermite spline): its first two
/// integrals are those of the true acceleration, whatever that is within the step. The error of the
/// mode is of order 4 in the step.
struct ModeStep {
  double eta_eta = 1.0, eta_deta = 0.0;  // free motion: row of eta
  double deta_eta = 0.0, deta_deta = 1.0;
  double eta_dv = 0.0, eta_dx = 0.0;  // excitation
  double deta_dv = 0.0, deta_dx = 0.0;

  ModeState from(const ModeState& s, const SlideMotion& m) const {
    return {eta_eta * s.eta + eta_deta * s.deta + eta_dv * m.dv + eta_dx * m.dx,
            deta_eta * s.eta + deta_deta * s.deta + deta_dv * m.dv + deta_dx * m.dx};
  }
};

/// @pre w > 0, 0 < zeta < 1, h > 0
ModeStep mode_step(const Mode& mode, double h);

}  // namespace servomill::plant
