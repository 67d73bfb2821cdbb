/// Reads how signals are recorded.
#pragma once

#include "sim/config/reader.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input {

/// Table [record]: sampling, storage and limits of the result file, and settle_ms before it begins.
/// @param out  its machine has been read
void read_record(config::Reader& root, model::Scenario& out);

}  // namespace servomill::sim::input
