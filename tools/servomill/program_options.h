/// The options of every command that reads a G-code program.
#pragma once

#include "sim/programs/canonical_moves.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

/// --machine, which some commands have in a form of their own, is left to them.
void add_program_options(Options& options);
void add_machine_option(Options& options);

/// Reads these options.
sim::programs::ProgramInputs program_inputs(const Options& options);

}  // namespace servomill::tools
