/// Modes of the structure under forces at the tip.
#pragma once

#include <vector>

#include "plant/structure/inertial_compliance.h"
#include "sim/config/reader.h"
#include "sim/model/machine.h"

namespace servomill::sim::input {

/// Reads the list `structural_mode` of a machine, where there is one.
/// @param machine  chain and periods are read
std::vector<plant::StructuralMode> read_structural_modes(config::Reader& machine_table,
                                                         const model::MachineSettings& machine);

}  // namespace servomill::sim::input
