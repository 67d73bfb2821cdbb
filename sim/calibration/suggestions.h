/// Measurements that would tell what readings cannot.
#pragma once

#include <string>
#include <vector>

#include "sim/calibration/calibration.h"
#include "sim/model/forward.h"

namespace servomill::sim::calibration {

/// For errors that the readings leave open, or know in combination only: the single set-up of
/// lasers, levels, squares, ball bars or probes after which they are known best, and how well. One
/// sentence for each set-up; one for the errors that no single one tells.
std::vector<std::string> suggestions(const Calibration& calibration,
                                     const model::MachineSettings& machine);

}  // namespace servomill::sim::calibration
