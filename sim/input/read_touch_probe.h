/// Reads the touch probe of a scenario and the bodies that it meets.
#pragma once

#include <memory>

#include "sim/config/reader.h"
#include "sim/evaluation/nominal_part.h"
#include "sim/model/touch_probe.h"

namespace servomill::sim::input {

/// Table [touch_probe]; nullptr without one. Faults are those of `root`.
/// @param stock, part  of the scenario: the workpiece that the probe may meet
std::shared_ptr<const model::TouchProbe> read_touch_probe(
    config::Reader& root, const plant::Stock& stock,
    const std::shared_ptr<const evaluation::NominalPart>& part);

}  // namespace servomill::sim::input
