/// How well the parameters of a fit are known, by the colour of what it leaves; and what the
/// recordings do not tell.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/identification/fit.h"
#include "sim/identification/residual_colour.h"

namespace servomill::sim::identification {

/// Estimates of which only combinations can be identified: a direction in which the recordings do
/// not change.
struct UnidentifiableDirection {
  std::vector<std::size_t> parameters;  // that take part
  Eigen::VectorXd direction;            // of all values
};

struct Uncertainty {
  Eigen::MatrixXd covariance;      // of the values; 0 for the unidentifiable
  std::vector<double> counted;     // standard deviations that counting samples would give
  std::vector<bool> identifiable;  // one for each value
  std::vector<UnidentifiableDirection> unidentifiable;
  std::vector<AutoregressiveNoise> noise;  // of each record
  double effective_samples = 0.0;          // of all records
  double t_95 = 2.0;                       // of Student's distribution, for intervals of 95 %

  double standard(std::size_t parameter) const;
  /// Half-width of the 95 % interval.
  double half_width(std::size_t parameter) const { return t_95 * standard(parameter); }
};

/// Covariance of least squares with coloured residuals,
///   C = (J'J)^-1 J' Sigma J (J'J)^-1,
/// Sigma from the autocovariance of the residual of each record as an autoregressive process. That
/// what the fit took away is missing in the residual is corrected: with H = J (J'J)^-1 J' the
/// residual has the covariance (I - H) Sigma (I - H), whose diagonals are compared with those
/// found.
/// Columns of `jacobian` that are 0 are parameters that have no effect.
/// @param mask  samples that count, record by record; the rows of the others are 0
Uncertainty uncertainty_of(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
                           const Mask& mask);

/// Quantile of Student's distribution for two-sided intervals of 95 %.
double student_95(double degrees_of_freedom);

}  // namespace servomill::sim::identification
