/// servomill table --import: a parameter file of a control as an error model.
#pragma once

#include "tools/servomill/command.h"

namespace servomill::tools {

/// Reads the files of --import, writes the error model to the file of --output, and prints what was
/// not taken over. The text is read back and compared with the parameter file before it is written.
/// @return exit status
/// @throws InputError
int import_errors(const Options& options);

}  // namespace servomill::tools
