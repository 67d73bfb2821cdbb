/// Options of the commands that work on readings of real machines.
#pragma once

#include <string>
#include <utility>

#include "sim/model/machine.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

/// The machine file of --machine, or the one that a file of readings names.
/// @param readings  empty: none
/// @throws InputError if there is neither
std::string measured_machine(const Options& options, const std::string& readings);

/// The same of `machine`, if it is not empty.
std::string measured_machine(const std::string& machine, const std::string& readings);

/// Travel of a machine (5 and 5; m, rad); infinite for an axis without one.
std::pair<Joints, Joints> travel_of(const sim::model::MachineSettings& machine);

}  // namespace servomill::tools
