/// Stability lobes of milling: the limiting depth of cut over the speed of the spindle.
///
/// With mean directional factors A_0 (N/m per m of depth) and the receptance
/// G(i w) = sum of d_i d_i^T / k_i / (1 - (w / w_i)^2 + 2 i zeta_i w / w_i) of the tool point, a
/// vibration of frequency w neither grows nor decays where
///
///     det(I + a (1 - exp(-i w T)) G A_0) = 0                                                   (1)
///
/// which an eigenvalue m(w) of G A_0 fulfils at
///
///     a = -1 / (2 Re m),   w T = pi + 2 arg m + 2 pi lobe                       (2)
///
/// For one mode m = d . A_0 d G: a = -1 / (2 d . A_0 d Re G). (2) is exact where A does not change
/// with the rotation: a slot with four straight teeth. Else A's mean is a first approximation
/// (zeroth order), which has no flip lobes; chatter_stability.h decides.
///
/// Sources: J. Tlusty, S. Polacek (1963); Y. Altintas, E. Budak, Analytical prediction of stability
/// lobes in milling, CIRP Annals 44 (1995).
#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

#include "plant/cutting/chatter_stability.h"

namespace servomill::plant {

/// A cut with the flank, at any depth and speed.
struct FlankEngagement {
  CuttingCoefficients coefficients;
  int teeth = 2;
  double from = 0.0, to = 0.0;  // rad, phi where a tooth enters and leaves, 0 <= from < to <= pi
  double helix = 0.0;           // rad
  double radius = 0.0;          // m, > 0 with a helix

  PeriodicCut at(double depth, double turns) const;
};

/// Receptance across the axis (m/N).
Eigen::Matrix2cd receptance(std::span<const ChatterMode> modes, double w);

/// Limit at a speed.
struct StabilityLimit {
  double depth = 0.0;      // m; infinite: stable at any depth (up to which it is searched)
  double frequency = 0.0;  // 1/s, of the vibration at the limit
  Chatter kind = Chatter::hopf;
};

/// Lowest depth that (1) has at a speed (turns, 1/s): closed form over all lobes.
StabilityLimit zeroth_order_limit(const FlankEngagement& cut, std::span<const ChatterMode> modes,
                                  double turns);

/// Lowest depth at which the largest multiplier reaches 1, within 0.1 %: searched upwards in
/// geometric steps of 10 % from a fiftieth of deepest on, then by bisection. Islands of instability
/// that are thinner are missed.
StabilityLimit limit_of_stability(const FlankEngagement& cut, std::span<const ChatterMode> modes,
                                  double turns, double deepest);

}  // namespace servomill::plant
