/// Reads the heat of a machine.
#pragma once

#include <memory>

#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// Table `heat` of a machine: surroundings, bodies, sources; nullptr if it has none. Faults: a
/// network that is not passive or not connected, sources of axes or bodies that there are not,
/// temperatures beyond the limits of their body.
/// @param machine  all else of it
std::shared_ptr<const model::HeatSettings> read_heat(config::Reader& machine_table,
                                                     const model::MachineSettings& machine);

}  // namespace servomill::sim::input
