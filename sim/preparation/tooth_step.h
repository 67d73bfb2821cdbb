/// Steps in which the force of single teeth follows the rotation of a cutter.
#pragma once

#include "plant/vocabulary/ticks.h"
#include "sim/model/scenario.h"

namespace servomill::sim::preparation {

/// Period of the force of the teeth (ticks): with the loops of a cascade the longest that divides
/// the period of the velocity loop and resolves a tooth passage, with ideal axes their position
/// period.
/// @param passing_frequency  1/s, of teeth
/// @param servo              of the case
/// @throws InputError at [cutting] if the tick or the position period of ideal axes is longer than
///         a step may be
Tick tooth_step(const model::CuttingSpec& cutting, double passing_frequency,
                const model::LoopPeriods& periods, model::ServoModel servo);

}  // namespace servomill::sim::preparation
