/// Rows of a group from its file.
#pragma once

#include <vector>

#include "sim/readings/readings.h"

namespace servomill::sim::readings {

/// Reads the rows of a group whose keys have been read.
/// @param lower, upper  travel (5; m, rad)
/// @param faults        receives what is wrong with rows
void read_rows(Group& group, const plant::MachineChain& chain, const Joints& lower,
               const Joints& upper, Numbers numbers, std::vector<Fault>& faults);

}  // namespace servomill::sim::readings
