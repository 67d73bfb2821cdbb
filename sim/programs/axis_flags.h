/// One flag for each axis word of a program.
#pragma once

#include <array>

#include "plant/vocabulary/axes.h"

namespace servomill::sim::programs {

using AxisFlags = std::array<bool, kAxisWords>;

}  // namespace servomill::sim::programs
