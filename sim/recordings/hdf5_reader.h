/// Signals of our own HDF5 files: results of every command, and recordings that were converted.
#pragma once

#include <string>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// Mark of files that write_recording() makes: attribute of the root, with the name of the source.
inline constexpr const char* kSourceAttribute = "recording_source";

/// Every group with a dataset `time` is a base, and the lists and tables of its length are
/// channels: "servo/true_linear_Y". Groups `frequency` of measured responses likewise.
/// @throws InputError
Recording read_hdf5(const std::string& path);

}  // namespace servomill::sim::recordings
