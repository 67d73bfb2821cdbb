/// The two-mass model of an axis fitted to a measured frequency response.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>

#include "sim/responses/period_response.h"

namespace servomill::sim::responses {

/// From a current (A) or torque to the angle of the motor, with the constants that a response
/// tells:
///
///   J_m phi'' = K i(t - dead_time) - b_m phi' - k (phi - psi) - c (phi' - psi')
///   J_l psi'' = -b_l psi' + k (phi - psi) + c (phi' - psi')
///
/// Only ratios can be identified: gain K/J_m, (k/J_l)^1/2 / 2 pi, J_l/J_m, c/J_l, b_m/J_m, b_l/J_l.
struct TwoMass {
  static constexpr std::size_t kParameters = 7;
  static constexpr std::array<std::string_view, kParameters> kNames = {
      "gain K/J_m",   "antiresonance", "inertia ratio J_l/J_m", "damping c/J_l", "motor b_m/J_m",
      "load b_l/J_l", "dead time"};
  static constexpr std::array<std::string_view, kParameters> kUnits = {
      "rad/(s^2 A)", "Hz", "1", "1/s", "1/s", "1/s", "s"};
  std::array<double, kParameters> value{};

  /// Response of the motor's angle at f (Hz).
  Complex at(double f) const;
  double antiresonance() const { return value[1]; }
  /// Hz, without damping: (k/J_l + k/J_m)^1/2 / 2 pi.
  double resonance() const;
};

struct TwoMassFit {
  TwoMass model;
  Eigen::MatrixXd covariance;  // of the values, with the model error in it
  double noise_ratio = 0.0;    // rms of the weighted residuals: 1 where noise explains them
  double median_misfit = 0.0;  // of |fit - measured| / |measured|
  double standard(std::size_t parameter) const;
  bool has_model_error() const { return noise_ratio > 1.5; }
};

/// Least squares weighted by the variance of each line, by Ceres Solver. Where the misfit exceeds
/// the noise the covariance is that of the misfit: the variances are scaled to it, and a floor as
/// great as the median misfit keeps lines that are measured best from carrying all the weight.
/// @throws InputError if the response has no antiresonance with a resonance above it
TwoMassFit fit_two_mass(const MeasuredResponse& response, const std::string& name);

}  // namespace servomill::sim::responses
