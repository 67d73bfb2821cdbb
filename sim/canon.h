/// Canonical moves of a program as text, and checking of input files.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim {

/// Hands every canonical move of a program to `line`, as one JSON object (no newline).
/// @param tool_table  file in LinuxCNC's format, or empty
/// @throws InputError
void canon(const std::string& program_file, const std::string& tool_table,
           const std::function<void(const std::string&)>& line);

/// All faults of a file: scenario or machine (.toml) or program (anything else).
/// @param changes     what --set says, for scenarios
/// @param tool_table  file in LinuxCNC's format, or empty, for programs
std::vector<Fault> check_file(const std::string& path, const std::vector<std::string>& changes,
                              const std::string& tool_table);

}  // namespace servomill::sim
