/// Uncertainty that identified errors pass on to whatever is computed from them.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "plant/geometry/error_model.h"
#include "sim/model/tip_uncertainty.h"

namespace servomill::sim::model {

/// Numbers that follow from an error model, always as many.
using FromErrors = std::function<Eigen::VectorXd(const plant::ErrorModel&)>;

/// Expanded uncertainty (k = 2) of each of them, in their units: first-order propagation of the
/// covariance, with derivatives from one standard deviation on either side (TipUncertainty).
/// @param errors  the model that was identified
Eigen::VectorXd expanded_uncertainty(const FromErrors& numbers, const plant::ErrorModel& errors,
                                     const UncertainErrors& identified);

}  // namespace servomill::sim::model
