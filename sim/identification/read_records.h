/// Recordings of an experiment, brought to the clock of its loop and to SI.
#pragma once

#include <vector>

#include "sim/config/reader.h"
#include "sim/identification/experiment.h"
#include "sim/model/forward.h"

namespace servomill::sim::identification {

/// Reads the list `recording` of an experiment and the files that it names. Faults go to the
/// reader.
/// @param machine  whose axes the channels belong to
/// @param files    named beside the experiment
std::vector<AxisRecord> read_records(config::Reader& root, const model::MachineSettings& machine,
                                     const LoopSettings& loop, const RecordingFiles& files);

}  // namespace servomill::sim::identification
