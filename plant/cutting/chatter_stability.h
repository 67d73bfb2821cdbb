/// Stability of milling with several modes of the tool point, by semi-discretisation.
///
///     q_i'' + 2 zeta_i w_i q_i' + w_i^2 q_i = w_i^2 / k_i  d_i . F,   x = sum of d_i q_i,
///     F = -A(t) (x(t) - x(t - T)),  A of directional_factors.h                                 (1)
///
/// T is divided into intervals: A is its mean over each, x(t - T) linear. The map of the state over
/// T (Floquet) is applied to a few vectors, whose span turns into that of its largest multipliers
/// (subspace iteration, Rayleigh-Ritz). Second order in the interval.
///
/// Source: T. Insperger, G. Stepan, Semi-discretization for time-delay systems, Springer 2011.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "plant/cutting/directional_factors.h"

namespace servomill::plant {

/// A mode across the axis of the cutter, in the frame of cutting_force.h.
struct ChatterMode {
  double stiffness = 0.0;                                // k, N/m
  double frequency = 0.0;                                // w, rad/s
  double damping = 0.0;                                  // zeta
  Eigen::Vector2d direction = Eigen::Vector2d::UnitY();  // d, unit, along e1 and e2
};

/// A steady cut of any engagement, for small vibrations about its forced motion.
struct PeriodicCut {
  CuttingCoefficients coefficients;
  int teeth = 2;
  double turns = 0.0;  // 1/s, of the spindle
  std::vector<EdgeSlice> slices;
  double passage() const { return 1.0 / (turns * teeth); }  // T, s
};

/// Kind of the vibration with the largest multiplier.
enum class Chatter : std::uint8_t {
  hopf,  // two frequencies, a pair of multipliers
  flip,  // multiplier < 0: it repeats after two teeth
  fold,  // multiplier > 0
};

struct ChatterStability {
  std::complex<double> multiplier;  // from tooth to tooth, Im >= 0; the cut is stable below 1
  double frequency = 0.0;           // 1/s, the strongest of the vibration
  bool is_stable() const { return std::abs(multiplier) < 1.0; }
  Chatter kind() const;
};

/// The largest multiplier of a cut.
class ChatterAnalysis {
 public:
  /// @param modes  at least one
  explicit ChatterAnalysis(std::span<const ChatterMode> modes)
      : modes_(modes.begin(), modes.end()) {}

  /// Starts from the vectors of the call before, if the number of intervals is the same.
  ChatterStability of(const PeriodicCut& cut);

 private:
  void resize(int intervals);
  Eigen::MatrixXd over_passage(const Eigen::MatrixXd& states,
                               const std::vector<Eigen::MatrixXd>& steps) const;
  std::vector<Eigen::MatrixXd> steps_of(const PeriodicCut& cut) const;
  double strongest(const Eigen::VectorXcd& state, std::complex<double> multiplier,
                   double passage) const;

  std::vector<ChatterMode> modes_;
  int intervals_ = 0;
  Eigen::MatrixXd vectors_;  // columns; q, q' / w of all modes, then x of the intervals before
};

}  // namespace servomill::plant
