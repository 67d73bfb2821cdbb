/// Reads how the structure gives way to the acceleration of the axes.
#pragma once

#include <string_view>
#include <vector>

#include "plant/structure/inertial_compliance.h"
#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// Table `inertial_deflection` of a machine: pairs of a direction and an axis, each static or a
/// mode. Absent: a rigid structure.
/// @pre chain and periods of the machine are read
std::vector<plant::InertialCompliance> read_inertial_deflection(
    config::Reader& table, const model::MachineSettings& machine);

/// Reads frequency_Hz and damping of a mode; without them it is static.
/// @param step  s, of which there must be 20 in each period of the mode; 0: it may be any
/// @param name  of the step, for messages
void read_mode(config::Reader& table, double step, std::string_view name, plant::Mode& mode);

}  // namespace servomill::sim::input
