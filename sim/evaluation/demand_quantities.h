/// Quantities of the motion that axes are asked for.
#pragma once

#include <span>

#include "sim/evaluation/quantity.h"

namespace servomill::sim::evaluation {

std::span<const QuantityEntry> demand_quantities();

}  // namespace servomill::sim::evaluation
