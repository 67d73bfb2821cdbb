/// Recordings of any known kind, recognised by their content.
#pragma once

#include <string>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// Names of the formats that are read, for the help.
std::string format_names();

/// @throws InputError if the file cannot be read or is of no kind that is known
Recording read_recording(const std::string& path);

}  // namespace servomill::sim::recordings
