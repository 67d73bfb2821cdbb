/// The options of `servomill compensate`.
#pragma once

#include <string>

#include "sim/programs/compensate/compensate.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

void add_compensate_options(Options& options);

/// Name of the corrected program, as --output or the program has it; "-": standard output.
std::string compensated_name(const Options& options);

/// Reads these options.
/// @throws InputError
sim::programs::CompensateRequest compensate_request(const Options& options);

}  // namespace servomill::tools
