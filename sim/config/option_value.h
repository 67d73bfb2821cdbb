/// Values of options of the command line: a number with a unit, or a bare one in the unit that the
/// help of the option names. Every option takes both.
#pragma once

#include <optional>
#include <string_view>

#include "sim/config/quantity.h"

namespace servomill::sim::config {

/// The finite number that a whole text is, or nullopt.
std::optional<double> plain_number(std::string_view text);

/// "3 mm", "3mm" or "3" in SI, or why it is none.
/// @param bare_unit  of a number without a unit
ScaledText scale_option(std::string_view text, Quantity quantity, std::string_view bare_unit);

}  // namespace servomill::sim::config
