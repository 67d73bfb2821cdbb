/// Reads the table [sweep] of a scenario.
#pragma once

#include <vector>

#include "sim/config/reader.h"
#include "sim/input/identified_values.h"
#include "sim/input/input_files.h"
#include "sim/model/design.h"

namespace servomill::sim::input {

/// A sweep as read.
struct SweepReading {
  model::SweepDesign design;
  std::vector<IdentifiedValues> identified;  // of the files of samples.from, in their order
};

/// All that sim/model/design.h describes. Faults are noted in the reader; whether the scenario has
/// the keys is for the sweep to find out.
SweepReading read_sweep(config::Reader& table, InputFiles& files);

}  // namespace servomill::sim::input
