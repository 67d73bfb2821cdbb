/// The control that a program itself says it was written for.
#pragma once

#include <cstdint>
#include <string>

#include "controllers/gcode/program_text.h"

namespace servomill::controllers {

/// A comment at the head that names one control; or else a program number as the first word, as
/// programs of Fanuc and Haas have it; or else a file of LinuxCNC's own ending, *.ngc. It decides
/// between readings only among the controls that would read the whole program.
struct ControlEvidence {
  std::uint8_t readers = 0;  // of `Reader`, a bit each; 0: the program does not say
  std::string text;          // "line 3 names Fanuc"
};

/// @param text  the whole program, from its first line
ControlEvidence control_evidence(ProgramText text);

}  // namespace servomill::controllers
