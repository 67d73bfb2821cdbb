/// Readers of the settings of each control (control_settings.h).
#pragma once

#include <string>
#include <string_view>

#include "sim/input/controls/control_settings.h"

namespace servomill::sim::input {

ControlSettings read_linuxcnc(std::string_view text, const std::string& file);
ControlSettings read_grbl(std::string_view text, const std::string& file);
ControlSettings read_fluidnc(std::string_view text, const std::string& file);
ControlSettings read_rrf(std::string_view text, const std::string& file);

}  // namespace servomill::sim::input
