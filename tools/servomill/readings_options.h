/// Options of the commands that work on readings of real machines.
#pragma once

#include <string>

#include "plant/vocabulary/axes.h"
#include "sim/readings/readings.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

/// The machine file of --machine, or the one that a file of readings names.
/// @param readings  empty: none
/// @throws InputError if there is neither
std::string measured_machine(const Options& options, const std::string& readings);

/// The same of `machine`, if it is not empty.
std::string measured_machine(const std::string& machine, const std::string& readings);

/// The machine that was measured; its file needs no drives.
struct MeasuredMachine {
  plant::MachineChain chain;
  Joints lower, upper;  // m, rad; travel, infinite for an axis without one
};

/// Reads the machine that measured_machine() names.
/// @throws InputError
MeasuredMachine read_measured_machine(const Options& options, const std::string& readings);

}  // namespace servomill::tools
