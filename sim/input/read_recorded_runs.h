/// Recordings of actual runs that a strategy learns from: [[case.strategy.recording]].
#pragma once

#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// Reads the tables of a strategy whose other keys have been read; none: it makes runs of its own.
/// @pre the strategy's entry has recorded_instead
void read_recorded_runs(config::Reader& table, model::StrategySpec& strategy);

}  // namespace servomill::sim::input
