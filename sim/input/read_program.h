/// Reads the program of a scenario, its subroutines and its tools.
#pragma once

#include <set>
#include <string>

#include "plant/vocabulary/axes.h"
#include "sim/config/reader.h"
#include "sim/input/input_files.h"
#include "sim/model/forward.h"
#include "sim/model/machine_test.h"

namespace servomill::sim::input {

/// Table [program]: file, reader, parameters, work offset, start and tools. A resolved document
/// holds the texts of all files.
/// @param tests  of the scenario; if there are any, the program is theirs, and there is no file
/// @throws InputError if a file cannot be read or its text cannot be stored in a result file
model::ProgramSpec read_program(config::Reader& table, const model::MachineSettings& machine,
                                InputFiles& files, const model::MachineTests& tests);

/// CRC-64 of a program, as a resolved document has it of a long one: 16 hexadecimal digits.
std::string checksum_text(const StoredText& program);

/// Program words such as X_mm = 1.5.
/// @param layout  of the machine; empty where that could not be read: any words are then taken
AxisWords read_offsets(config::Reader& table, const JointLayout& layout);

/// M codes of the key `ignore_codes`; `fallback` where it is absent.
std::set<int> read_ignored_codes(config::Reader& table, const std::set<int>& fallback);

}  // namespace servomill::sim::input
