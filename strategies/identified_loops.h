/// Position loops of a machine as a strategy knows them: exact sampled responses of each axis, and
/// its friction.
#pragma once

#include <array>
#include <complex>
#include <memory>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::strategies {

/// Linear responses of one axis under its sampled loops, at rising frequencies.
struct LoopResponse {
  std::vector<double> f;  // Hz
  /// Position over a displacement that is found from a reading, acts one model period later, is
  /// held for one and then added to what the position loop reads; -1 at low frequencies.
  std::vector<std::complex<double>> displacement;
  std::vector<std::complex<double>> current;  // A/m or A/rad, over the same displacement
  std::vector<std::complex<double>> force;    // m/N or rad/(N m): position over force on the slide
};

/// Dry friction of one axis by the LuGre model (bristle_model.h); for a rotary axis read N m for N.
struct BristleFriction {
  double Fc_positive = 0.0, Fc_negative = 0.0;  // N, Coulomb force against motion in + and -
  double Fs_positive = 0.0, Fs_negative = 0.0;  // N, breakaway force
  double b_positive = 0.0, b_negative = 0.0;    // N s/m, viscous, beside that of the response
  double vs = 1.0;                              // m/s, Stribeck velocity
  double sigma0 = 0.0;                          // N/m, stiffness of the bristles; 0: no friction
  double sigma1 = 0.0;                          // N s/m, their damping
  bool operator==(const BristleFriction&) const = default;
};

struct IdentifiedLoops {
  double model_period = 0.0;  // s, of the displacement
  // nullptr where there is no axis
  std::array<std::shared_ptr<const LoopResponse>, kJoints> responses;
  std::array<BristleFriction, kJoints> friction;
  std::array<double, kJoints> reading_noise{};  // m, rad: standard deviation of one scale reading
};

}  // namespace servomill::strategies
