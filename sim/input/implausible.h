/// Values of a machine that no machine tool has: most are bare numbers that were meant in another
/// unit, such as stiffness = 180 for 180 N/um.
#pragma once

#include <string>
#include <vector>

#include "sim/model/forward.h"

namespace servomill::sim::input {

/// "axis.X.stiffness = 180 N/m; ...", one for each value.
std::vector<std::string> implausible_values(const model::MachineSettings& machine, int joint);
std::vector<std::string> implausible_values(const model::MachineSettings& machine);

}  // namespace servomill::sim::input
