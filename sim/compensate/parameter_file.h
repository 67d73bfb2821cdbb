/// Parameter files of LinuxCNC: what the machine knows from earlier programs, its work offsets
/// above all.
#pragma once

#include <string>
#include <string_view>

#include "controllers/gcode/interpreter.h"

namespace servomill::sim {

/// Puts the parameters of a file ("5221 10.5" a line, mm and degrees) into a setup: work offsets
/// with their rotation, the work system in force, all others by number.
/// @throws InputError with every faulty line
void take_parameter_file(std::string_view text, const std::string& file,
                         controllers::ProgramSetup& setup);

}  // namespace servomill::sim
