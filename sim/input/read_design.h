/// Reads the table [sweep] of a scenario.
#pragma once

#include "sim/config/reader.h"
#include "sim/model/design.h"

namespace servomill::sim::input {

/// All that sim/model/design.h describes. Faults are noted in the reader; whether the scenario has
/// the keys is for the sweep to find out.
model::SweepDesign read_sweep(config::Reader& table);

}  // namespace servomill::sim::input
