/// The same as `harmonic` with 4 a t (1 - t), which the error is to leading order: for the same
/// points a thirtieth of the residual.
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry parabolic_entry();

}  // namespace servomill::strategies
