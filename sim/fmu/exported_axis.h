/// The axis of a scenario that is exported.
#pragma once

#include "sim/fmu/axis_constants.h"
#include "sim/model/scenario.h"

namespace servomill::sim::fmu {

/// Constants of one joint of the machine of a scenario, without the name of a case.
/// @param reading_delay  ticks between the scale and what the position loop reads
AxisConstants exported_axis(const model::Scenario& scenario, int joint, Tick reading_delay);

}  // namespace servomill::sim::fmu
