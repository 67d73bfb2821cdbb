/// Declarations of strategies in C (strategies/plugin_c.h), checked.
#pragma once

#include <string>

#include "strategies/plugin_c.h"

namespace servomill::strategies {

/// Why a strategy cannot be used as it is declared; empty if it can. A struct of a library that was
/// built with earlier headers of this ABI version is shorter, one of later headers longer: the
/// latter can be used if all that this program does not know is NULL.
std::string wrong_with(const servomill_strategy& declared);

/// The declaration as this program knows it: what an earlier one lacks is NULL.
/// @pre wrong_with(declared) is empty
servomill_strategy completed(const servomill_strategy& declared);

}  // namespace servomill::strategies
