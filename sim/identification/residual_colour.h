/// The colour of residuals: their autocovariance as an autoregressive process, and how many
/// independent samples they are worth.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace servomill::sim::identification {

/// An autoregressive process e(n) + a_1 e(n-1) + ... + a_p e(n-p) = w(n).
struct AutoregressiveNoise {
  std::vector<double> a;               // a_1 ... a_p
  double innovation = 0.0;             // variance of w
  std::vector<double> autocovariance;  // at lags 0, 1, ... to where it has decayed

  /// Samples of white noise that tell as much of a variance: n c(0)^2 / sum over all lags of c^2.
  double effective_samples(std::size_t n) const;
};

/// Autocovariance of a residual at lags 0 to `lags`, divided by the number of samples (positive
/// semi-definite).
std::vector<double> autocovariance(const Eigen::VectorXd& residual, std::size_t lags);

/// The process of which the first autocovariances are those, its order chosen by the corrected
/// criterion of Akaike (Hurvich and Tsai 1989) among 0 to c.size() - 1.
/// @param samples  that the autocovariances were computed from
AutoregressiveNoise autoregressive(const std::vector<double>& c, std::size_t samples);

/// Highest order that so many samples carry.
std::size_t most_lags(std::size_t samples);

/// Columns convolved with the autocovariance: Sigma X, Sigma the covariance of the process.
Eigen::MatrixXd coloured(const AutoregressiveNoise& noise, const Eigen::MatrixXd& X);

/// Sums over n of x(n) y(n + lag) for lags 0 to `lags`, both ways added: what U V' + V U' has on
/// its diagonals.
std::vector<double> cross_sums(const Eigen::MatrixXd& U, const Eigen::MatrixXd& V,
                               std::size_t lags);

}  // namespace servomill::sim::identification
