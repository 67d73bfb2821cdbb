/// A program as it lies in a machine: its work offsets, tools and the position before it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/input_error.h"
#include "sim/model/machine.h"
#include "sim/programs/canonical_moves.h"
#include "sim/programs/given_setup.h"

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

struct PlacedProgram {
  model::MachineSettings machine;
  bool has_drives = false;
  GivenSetup given;
  bool is_start_known = false;

  /// @param start  machine position before the program (6; m, rad)
  void begin_at(const AxisWords& start);
};

/// @throws InputError
PlacedProgram placed_program(const ProgramPlacement& placement);

/// Interprets a program and hands over its blocks in their order.
/// @return what the interpreter put right
/// @throws InputError with all faults of the program
std::vector<Fault> read_blocks(
    const std::string& program_file, const controllers::ProgramSetup& setup,
    const std::function<void(const controllers::ExecutedBlock& block)>& take);

}  // namespace servomill::sim::programs
