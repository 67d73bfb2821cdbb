/// Reads how signals are recorded.
#pragma once

#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// Table [record]: sampling, storage and limits of the result file, and settle_ms before it begins.
/// @param out  its machine has been read
void read_record(config::Reader& root, model::Scenario& out);

/// Notes faults of rows that are left out although tests or probes of the scenario need them.
/// @param scenario  tests and probes are read
void check_record(config::Reader& root, const model::Scenario& scenario);

}  // namespace servomill::sim::input
