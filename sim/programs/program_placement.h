/// Which program lies where in which machine, as the user has given it.
#pragma once

#include <string>
#include <vector>

#include "sim/programs/canonical_moves.h"

namespace servomill::sim::programs {

struct ProgramPlacement {
  std::string program_file;
  ProgramInputs inputs;                        // with the machine
  std::vector<std::string> changes = {};       // "KEY=VALUE", of the machine file
  std::vector<std::string> work_offsets = {};  // "G54:X=10,Y=-5"
  std::vector<std::string> tool_lengths = {};  // "1=50"
  /// "X=0,Y=0,Z=50": machine position before the program, from which every position is known.
  /// Empty: positions are known as far as the program names them.
  std::string start = {};
};

}  // namespace servomill::sim::programs
