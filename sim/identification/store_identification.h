/// An identification on disk: measured and simulated signals, residuals and their colour,
/// parameters.
#pragma once

#include <string>

namespace servomill::sim::identification {

struct Experiment;      // sim/identification/experiment.h
struct Identification;  // sim/identification/identification.h

/// Writes the result as HDF5. Layout: README.md of this room.
/// @throws InputError if the file exists and `force` is not set, SystemError
void store_identification(const Experiment& experiment, const Identification& result,
                          const std::string& path, bool force);

}  // namespace servomill::sim::identification
