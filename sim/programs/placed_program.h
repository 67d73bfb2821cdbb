/// A program as it lies in a machine: its work offsets, tools and the position before it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/input_error.h"
#include "sim/model/machine.h"
#include "sim/programs/given_setup.h"
#include "sim/programs/program_placement.h"

namespace servomill::sim::programs {

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
