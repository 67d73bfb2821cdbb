/// Modes of the structure under forces at the tip.
#pragma once

#include <vector>

#include "plant/structure/inertial_compliance.h"
#include "sim/config/reader.h"

namespace servomill::sim::input {

/// Reads the list `structural_mode` of a machine, where there is one.
/// @param step  s, that has to resolve the modes; 0: none has to
std::vector<plant::StructuralMode> read_structural_modes(config::Reader& machine_table,
                                                         double step);

}  // namespace servomill::sim::input
