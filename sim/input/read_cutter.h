/// Reads the cutting part of a tool.
#pragma once

#include <optional>

#include "plant/cutting/cutter.h"
#include "sim/config/reader.h"

namespace servomill::sim::input {

/// Keys corner_radius_mm (default 0: flat), flute_length_mm (default: four diameters), teeth (2),
/// helix_deg (30), runout_um (0) and runout_direction_deg (0) of a tool.
/// @param diameter  m; without one a tool cuts nothing, and these keys are faults
std::optional<plant::Cutter> read_cutter(config::Reader& tool, double diameter);

}  // namespace servomill::sim::input
