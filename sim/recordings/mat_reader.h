/// MAT files of MATLAB, level 5 (libmatio).
#pragma once

#include <string>
#include <string_view>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// True for the 128 bytes that level 5 begins with.
bool is_mat(std::string_view bytes);

/// Vectors and tables of numbers as channels: the variable `t`, `time` or `Zeit` is their time,
/// else samples are numbered. Single numbers, variables of another length than the time and objects
/// that are no arrays of numbers are named in the notes. The file holds no units.
/// @param bytes  of the file: what the library does not see is whether it is cut off
/// @throws InputError
Recording read_mat(std::string_view bytes, const std::string& path);

}  // namespace servomill::sim::recordings
