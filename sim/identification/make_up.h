/// A recording of an experiment made up (synthesize.h), as a file.
#pragma once

#include <string>

#include "sim/identification/experiment.h"

namespace servomill::sim::identification {

/// Writes command, feedback and force of each axis, in its first recording, as they would be if the
/// machine had the starting values: for planning an experiment, and for trying out what it would
/// tell. Recordings of other instants have a time base of their own, which HDF5 alone holds.
/// @throws InputError if a recording has no command, or the file may not be written
void make_up(const Experiment& experiment, const std::string& path, bool force);

}  // namespace servomill::sim::identification
