/// The program that a recorded motion is of.
#pragma once

#include <optional>

#include "sim/programs/program_placement.h"

namespace servomill::sim::limits {

struct ProgramRequest {
  programs::ProgramPlacement placement;
  std::optional<double> tolerance = {};  // m, in place of that of the program and of the machine
};

}  // namespace servomill::sim::limits
