/// Canonical moves of a program as text, and checking of input files.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/program_setup.h"
#include "plant/vocabulary/input_error.h"
#include "sim/model/forward.h"

namespace servomill::sim::programs {

/// Inputs of a program next to its text.
struct ProgramInputs {
  std::string tool_table;                            // file in LinuxCNC's format, or empty
  std::vector<std::string> parameters;               // "#101=1394"
  std::string machine = {};                          // file of the machine that runs it, or empty
  std::string parameter_file = {};                   // LinuxCNC's "var" file, or empty
  std::vector<std::string> subroutine_folders = {};  // beside that of the program
  /// One of controllers::kReaders; none: that of the machine file, or any.
  std::optional<std::string> reader = {};
  /// One of controllers::kDecimalPoints; none: that of the machine file, or unset.
  std::optional<std::string> decimal_point = {};
  std::optional<double> feed = {};                   // m/s, of moves before any F
  std::vector<std::string> additional_offsets = {};  // "P3:X=10,Y=5", of G54.1 P3; mm
  std::vector<std::string> ignored_codes = {};       // "M82", of the machine's builder
  bool block_delete = false;                         // leave out lines that start with '/'
  long most_jumps = 1'000'000;                       // loops turned and subroutines called
  /// Shared by the runs of one program; nullptr: each run makes its own.
  std::shared_ptr<controllers::SharedTrials> trials = {};
};

/// Takes the reader that the inputs name, else that of the machine file.
/// @throws InputError
void choose_reader(const ProgramInputs& inputs, const model::NcSettings& nc,
                   controllers::ProgramSetup& setup);

/// Settings of the control before the program runs.
/// @throws InputError
controllers::ProgramSetup program_setup(const ProgramInputs& inputs,
                                        const std::string& program_file);

/// Hands the canonical moves of a program to `write`, as one JSON object a line, many lines at a
/// time. Neither the program nor its moves are held.
/// @return what the interpreter put right
/// @throws InputError; the moves before the fault, and its record, have been handed over
std::vector<Fault> canon(const std::string& program_file, const ProgramInputs& inputs,
                         const std::function<void(std::string_view)>& write);

/// True of files that are neither scenarios, machines nor cutter locations.
bool is_program(std::string_view path);

/// A file as checking it found it.
struct CheckedFile {
  std::vector<Fault> faults;
  std::vector<Fault> warnings;  // programs beyond LinuxCNC's rules, values that no machine has
  std::string not_run;          // what only a run would check; empty: nothing
};

/// Checks a file: scenario or machine (.toml), cutter locations (.cls, .apt, .csv) or program
/// (anything else).
/// @param changes  what --set says, for scenarios
/// @param inputs   for programs
CheckedFile check_file(const std::string& path, const std::vector<std::string>& changes,
                       const ProgramInputs& inputs);

}  // namespace servomill::sim::programs
