/// Text of (DEBUG, ...) and (PRINT, ...).
#pragma once

#include <string>
#include <string_view>

#include "controllers/gcode/parameters.h"

namespace servomill::controllers {

/// The text with #5 and #<name> replaced by their values, an undefined name and a number out of
/// range by ######. Values have six decimals, until %d (none), %f (four) or %.3f says otherwise;
/// these words are left out. As LinuxCNC has it, what is within 1e-4 of zero reads as zero.
std::string message_text(std::string_view text, const Parameters& parameters);

}  // namespace servomill::controllers
