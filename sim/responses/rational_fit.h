/// A rational transfer function with a dead time, fitted to a measured frequency response.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/responses/period_response.h"

namespace servomill::sim::responses {

/// G(s) = (b0 + b1 p + ... + bN p^N) / (a0 + ... + p^M) exp(-s dead_time),  p = s / w0.
struct Rational {
  std::vector<double> b, a;  // ascending powers; the last of a is 1
  double w0 = 1.0;           // rad/s, in the middle of the lines
  double dead_time = 0.0;    // s
  Complex at(double f) const;
};

/// A pole or zero, or a conjugate pair of them: s^2 + 2 damping w s + w^2; a real one has the
/// damping +-1.
struct Root {
  double frequency = 0.0, damping = 0.0;                      // Hz, 1
  double frequency_deviation = 0.0, damping_deviation = 0.0;  // standard deviations
  bool is_pair = false;
};

struct RationalFit {
  Rational model;
  Eigen::MatrixXd covariance;  // of b, then of a without the last, then of the dead time if fitted
  std::vector<Root> zeros, poles;
  double dead_time_deviation = 0.0;  // s; 0: not fitted
  double noise_ratio = 0.0, median_misfit = 0.0;
  bool has_model_error() const { return noise_ratio > 1.5; }
};

struct RationalOrder {
  int numerator = 0, denominator = 0;
  bool with_dead_time = false;
};
inline constexpr int kMaxOrder = 12;

/// Least squares weighted by the variance of each line: linear iterations (Sanathanan and Koerner),
/// then Levenberg and Marquardt. Where the misfit exceeds the noise the covariance is that of the
/// misfit, as of the two-mass fit.
/// @throws InputError if there are fewer lines than the order needs
RationalFit fit_rational(const MeasuredResponse& response, const RationalOrder& order,
                         const std::string& name);

}  // namespace servomill::sim::responses
