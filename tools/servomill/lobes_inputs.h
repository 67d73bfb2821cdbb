/// Data of a stability chart that files give.
#pragma once

#include <optional>
#include <vector>

#include "sim/frequency/lobes.h"

namespace servomill::tools {

class Options;

/// Data of a machine or a scenario; options override them.
struct LobesInputs {
  std::vector<plant::StructuralMode> modes;
  std::optional<plant::CuttingCoefficients> coefficients;
  plant::Cutter cutter = {.teeth = 0};  // radius 0, teeth 0: none
};

/// Reads the file of the command, the tool of a scenario as --tool has it.
/// @return nothing without a file
/// @throws InputError
LobesInputs lobes_inputs(const Options& options);

}  // namespace servomill::tools
