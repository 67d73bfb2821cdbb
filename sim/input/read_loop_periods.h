/// Reads the periods of the loops of an NC, and its position-setpoint filter.
#pragma once

#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

inline constexpr double kLongestPeriod = 1.0;  // s

/// Base period and periods of the loops: those of the preset or own ones.
model::LoopPeriods read_periods(config::Reader& nc);

/// @param periods  as read
model::NominalFilter read_filter(config::Reader& nc, const model::LoopPeriods& periods);

}  // namespace servomill::sim::input
