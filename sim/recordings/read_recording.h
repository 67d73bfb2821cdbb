/// Recordings of any known kind, recognised by their content.
#pragma once

#include <string>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// Names of the formats that are read, for the help.
std::string format_names();

/// @param time_unit  of a time whose unit the file does not say; empty: s
/// @throws InputError if the file cannot be read or is of no kind that is known
Recording read_recording(const std::string& path, const std::string& time_unit = "");

}  // namespace servomill::sim::recordings
