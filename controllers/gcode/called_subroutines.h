/// Which subroutines a program may ask for.
#pragma once

#include <set>
#include <string>

#include "controllers/gcode/program_text.h"

namespace servomill::controllers {

/// The names that `O<name> CALL`, `O100 CALL` and `M98 P100` call in a program, those that it
/// defines among them. Labels that are computed are not known before the program runs. What cannot
/// be read is passed over.
std::set<std::string> called_subroutines(ProgramText text);

}  // namespace servomill::controllers
