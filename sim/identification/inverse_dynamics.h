/// Inertia and friction of an axis from position and force by linear least squares: no simulation,
/// no starting values. For the starting values of a fit, and to compare with the literature.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "sim/identification/record.h"
#include "sim/identification/uncertainty.h"

namespace servomill::sim::identification {

/// Filters of the method, made explicit.
struct InverseDynamicsSettings {
  double position_corner = 100.0;  // Hz, of the position before it is differentiated
  double force_corner = 40.0;      // Hz, of force and columns alike (parallel filtering)
  int order = 4;                   // of Butterworth filters, run forwards and backwards
  double ends = 0.2;               // s, left out at both ends
  /// True: a digital force is held from its sample on, and so acts half a period later than it is
  /// recorded. False: it is taken as it is recorded, as the literature does.
  bool held = true;
};

/// force = M a + Fv v + Fc sgn(v) + offset, or with Fv and Fc of their own for each direction,
/// where the offset cannot be separated from the Coulomb friction.
struct InverseDynamics {
  bool by_direction = false, held = true;
  std::vector<std::string>
      names;                   // "mass", "viscous friction", "Coulomb friction", "offset"; "... +"
  std::vector<double> values;  // kg, N s/m, N, N (kg m^2, ... for a rotary axis)
  Uncertainty uncertainty;
  double misfit = 0.0;  // rms of the residual over rms of the filtered force
};

/// @throws InputError if the record has no force, hardly accelerates, or never slides
InverseDynamics inverse_dynamics(const Record& record, bool by_direction,
                                 const InverseDynamicsSettings& settings = {});

/// Difference of the viscous friction by direction in standard deviations, and the same of the
/// Coulomb friction less twice the offset of the symmetric law: where one is beyond 3 the symmetric
/// law is rejected.
struct SymmetryTest {
  double viscous = 0.0;
  bool rejected() const { return std::abs(viscous) > 3.0; }
};
SymmetryTest test_symmetry(const InverseDynamics& by_direction);

}  // namespace servomill::sim::identification
