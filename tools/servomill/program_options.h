/// The options of every command that reads a G-code program.
#pragma once

#include "sim/canon.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

void add_program_options(Options& options);

/// What they said.
sim::ProgramInputs program_inputs(const Options& options);

}  // namespace servomill::tools
