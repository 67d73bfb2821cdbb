/// The options of every command that reads a G-code program.
#pragma once

#include "sim/programs/canonical_moves.h"
#include "sim/programs/program_placement.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

/// --machine, which some commands have in a form of their own, is left to them.
void add_program_options(Options& options);
void add_machine_option(Options& options);

/// Reads these options.
sim::programs::ProgramInputs program_inputs(const Options& options);

/// Place of the program in the machine: --work-offset, --tool-length, --start.
void add_placement_options(Options& options);

/// Reads all of these options, --machine and the changes of --set.
sim::programs::ProgramPlacement program_placement(const Options& options,
                                                  const std::string& program_file);

}  // namespace servomill::tools
