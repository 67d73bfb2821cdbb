/// Output of EPICS camonitor.
#pragma once

#include <string>
#include <string_view>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// True for lines of a process variable, a date, a time and a value.
bool is_camonitor(std::string_view text);

/// Lines "PV 2024-03-01 10:00:00.250000 value [status severity]". Each process variable has its own
/// times; zero is the first instant of the file, of which a note gives date and time. Variables
/// that hold texts or arrays, times that are not defined, and messages ("*** disconnected") are
/// counted in the notes, alarms as well. A line that repeats time and value is taken once.
/// @throws InputError with line and column
Recording parse_camonitor(std::string_view text, const std::string& file);

}  // namespace servomill::sim::recordings
