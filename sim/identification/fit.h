/// Values of the parameters with which the simulation is nearest to the recordings.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "sim/identification/prediction.h"

namespace servomill::sim::identification {

struct Fit {
  Values values;
  Values scales;  // change of each that moves the feedback by the residual's rms; NaN: none does
  Eigen::VectorXd residual;  // m or rad, simulated less recorded
  Eigen::MatrixXd jacobian;  // of the residual by the values
  int iterations = 0;
  bool converged = false;
  std::string message;  // of the minimiser
};

/// Least sum of squares of simulated less recorded feedback, by Ceres Solver (trust region,
/// Levenberg and Marquardt) within the bounds; derivatives by central differences, all values side
/// by side. Parameters of which nothing depends stay as they are.
/// @throws InputError if the starting values cannot be simulated
Fit fit(const Prediction& prediction, const Values& start, const Mask& mask);

/// Sum of squares of the residual with one parameter held at a value and all others fitted; they
/// begin at `values` and end there.
/// @param fit  whose scales are those of the parameters
/// @return nothing where the simulation refuses the values
std::optional<double> fit_others(const Prediction& prediction, const Fit& fit, const Mask& mask,
                                 std::size_t parameter, Values& values);

/// Root mean square of a vector over the samples that count.
double rms(const Eigen::VectorXd& residual, const Mask& mask);

}  // namespace servomill::sim::identification
