/// Reads the modes of the tool point under cutting forces.
#pragma once

#include <vector>

#include "plant/structure/tool_point_mode.h"
#include "sim/config/reader.h"

namespace servomill::sim::input {

/// Tables `tool_point_mode` of a machine. Absent: a tool point without vibration.
std::vector<plant::ToolPointMode> read_tool_point_modes(config::Reader& machine_table);

}  // namespace servomill::sim::input
