/// Quantities of the parts of a day.
#pragma once

#include <span>

#include "sim/evaluation/quantity.h"

namespace servomill::sim::evaluation {

std::span<const QuantityEntry> day_quantities();

}  // namespace servomill::sim::evaluation
