/// The example of sim/evaluation/README.md, "Add a quantity".
#pragma once

#include <span>

#include "sim/evaluation/quantity.h"

namespace servomill::sim::evaluation {

std::span<const QuantityEntry> lateral_quantities();

}  // namespace servomill::sim::evaluation
