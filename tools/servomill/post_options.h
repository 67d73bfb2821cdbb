/// The options of `servomill post`.
#pragma once

#include "sim/programs/post_file.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

void add_post_options(Options& options);

/// Reads these options.
/// @throws InputError
sim::programs::PostRequest post_request(const Options& options);

}  // namespace servomill::tools
