/// The only door to the TOML library.
#pragma once

#include <string>
#include <string_view>

#include "sim/config/value.h"

namespace servomill::sim::config {

/// The root table of a TOML text.
/// @param name  of the file, for places
/// @throws InputError at the first fault of syntax
Value parse_toml(std::string_view text, const std::string& name);

}  // namespace servomill::sim::config
