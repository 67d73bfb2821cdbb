/// Modified position feedback (virtual encoder): the NC reads x_measured + d and moves the axis by
/// -d. Knows neither the program nor its origin: the error is evaluated in machine coordinates.
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry feedback_entry();

}  // namespace servomill::strategies
