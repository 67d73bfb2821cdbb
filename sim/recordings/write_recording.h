/// Recordings as CSV and HDF5.
#pragma once

#include <string>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// Refuses before any work what cannot be written: a name that ends neither in .csv nor in .h5.
/// @throws InputError
void refuse_unknown_kind(const std::string& path);

/// A recording of one base as a table: "time [s],name [unit],..."; missing samples are empty
/// fields, numbers have the digits that restore every bit.
/// @throws InputError if it has several bases
std::string to_csv(const Recording& recording);

/// Writes CSV or HDF5, by the end of the name.
/// @throws InputError if the file is there and `force` is not set, SystemError
void write_recording(const Recording& recording, const std::string& path, bool force);

}  // namespace servomill::sim::recordings
