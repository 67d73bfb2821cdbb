/// Quantities of what is not known of the tool: uncertainties that identified errors leave.
#pragma once

#include <span>

#include "sim/evaluation/quantity.h"

namespace servomill::sim::evaluation {

/// Entries of this family. They take the covariance of the identified errors of the machine.
std::span<const QuantityEntry> uncertainty_quantities();

}  // namespace servomill::sim::evaluation
