/// Constants of a scenario that an FMU contains.
#pragma once

#include "sim/fmu/machine_constants.h"
#include "sim/model/forward.h"

namespace servomill::sim::fmu {

/// Constants of one joint of the machine of a scenario, without the name of a case.
/// @param reading_delay  ticks between the scale and what the position loop reads
AxisConstants exported_axis(const model::Scenario& scenario, int joint, Tick reading_delay);

/// Kinematics of the machine of a scenario with its true errors: those of its case if it has only
/// one, which may have its own.
/// @throws InputError if the cases do not agree on the errors
KinematicConstants exported_kinematics(const model::Scenario& scenario);

}  // namespace servomill::sim::fmu
