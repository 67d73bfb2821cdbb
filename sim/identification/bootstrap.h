/// Uncertainty of a fit without a model of its noise: block bootstrap of the residual.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/identification/identify.h"
#include "sim/identification/uncertainty.h"

namespace servomill::sim::identification {

/// Values of estimates from recordings made up of the fit and its shuffled residual.
struct Bootstrap {
  Eigen::MatrixXd values;          // a row a replica, in the order of all values
  std::vector<std::size_t> block;  // samples of a block, of each record

  /// NaN for fewer than two replicas.
  double standard(std::size_t parameter) const;
  /// The 2.5 % and 97.5 % quantiles; NaN for fewer than forty replicas.
  std::pair<double, double> interval_95(std::size_t parameter) const;
};

/// Length of blocks that serves variances best, for scores of any spectrum:
///   L = (1.5 (G/g)^2 n)^(1/3),  G = sum |k| |c(k)|, g = sum |c(k)| over all lags k.
/// Source: Politis and White, Automatic block-length selection for the dependent bootstrap,
/// Econometric Reviews 23 (2004) 53-70, with D = 4/3 g^2 for circular blocks (Patton, Politis and
/// White 2009); absolute values, since scores are of any frequency where a mean is of zero.
std::size_t block_length(const std::vector<double>& autocovariance, std::size_t samples);

/// Circular blocks of each record's centred residual are drawn with replacement, scaled by what the
/// fit took away, and added to the fit; each replica is estimated by the derivatives of the fit:
/// values - (J'J)^-1 J' shuffled. Equal for equal seeds. Estimating with the simulation itself
/// fails where friction makes a residual jump; profiles show what is not linear.
/// @pre the fit has identifiable parameters
Bootstrap bootstrap(const Fit& fit, const Uncertainty& uncertainty, const Mask& mask,
                    const BootstrapSettings& settings);

}  // namespace servomill::sim::identification
