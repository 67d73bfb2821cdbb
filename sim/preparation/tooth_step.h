/// Steps in which the force of single teeth follows the rotation of a cutter.
#pragma once

#include "plant/vocabulary/ticks.h"
#include "sim/model/forward.h"
#include "sim/model/run_settings.h"

namespace servomill::sim::preparation {

/// Period of the force of the teeth (ticks): with the loops of a cascade the longest that divides
/// the period of the velocity loop and resolves a tooth passage and a mode, with ideal axes their
/// position period.
/// @param passing_frequency  1/s, of teeth
/// @param highest_mode       1/s, frequency of the fastest mode that vibrates; 0: none does
/// @param servo              of the case
/// @throws InputError at [cutting] if the tick or the position period of ideal axes is longer than
///         a step may be
Tick tooth_step(const model::CuttingSpec& cutting, double passing_frequency, double highest_mode,
                const model::LoopPeriods& periods, model::ServoModel servo);

}  // namespace servomill::sim::preparation
