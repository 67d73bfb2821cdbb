/// Takes the nonlinear error of lines with rotary axes away as a sin(pi t), a its value in the
/// middle: the compensation of X. Li (2024) as published, for both definitions of the error.
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry harmonic_entry();

}  // namespace servomill::strategies
