/// Canonical moves of a program as text, and checking of input files.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim {

/// What a program needs beside its text.
struct ProgramInputs {
  std::string tool_table;               // file in LinuxCNC's format, or empty
  std::vector<std::string> parameters;  // "#101=1394"
  std::string machine = {};             // file of the machine that runs it, or empty
};

/// Hands every canonical move of a program to `line`, as one JSON object (no newline).
/// @return what the interpreter put right
/// @throws InputError
std::vector<Fault> canon(const std::string& program_file, const ProgramInputs& inputs,
                         const std::function<void(const std::string&)>& line);

/// All faults of a file: scenario or machine (.toml), cutter locations (.cls, .apt, .csv) or
/// program (anything else).
/// @param changes     what --set says, for scenarios
/// @param inputs   for programs
std::vector<Fault> check_file(const std::string& path, const std::vector<std::string>& changes,
                              const ProgramInputs& inputs);

}  // namespace servomill::sim
