/// Actions of a program for LinuxCNC, read by the interpreter of this project.
#pragma once

#include <string>
#include <vector>

#include "controllers/dialects/machine_action.h"
#include "controllers/gcode/program_setup.h"
#include "sim/programs/verification/original.h"

namespace servomill::sim::programs {

/// Positions count from `setup.start`: LinuxCNC moves no axis that the program does not name.
/// @throws InputError
std::vector<controllers::MachineAction> replay_linuxcnc(const std::string& text,
                                                        const std::string& file,
                                                        const controllers::ProgramSetup& setup,
                                                        const OriginalOptions& options);

}  // namespace servomill::sim::programs
