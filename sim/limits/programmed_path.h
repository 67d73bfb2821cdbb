/// The path of a program in a machine, against which a recorded motion is held.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "controllers/path/tool_centre_point.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"
#include "sim/engine/program_path.h"
#include "sim/limits/program_request.h"

namespace servomill::sim::limits {

struct ProgrammedPath {
  std::string program;
  engine::ProgramPath path;
  std::vector<double> tolerance;  // m, of each piece of the path
  std::shared_ptr<const controllers::ToolCentrePoint> machine;
  std::vector<Fault> warnings = {};
};

/// @param start  machine position before the program (6; m, rad), unless the placement has one
/// @throws InputError with all faults of the program; where a position depends on a work offset or
/// a tool length that neither it nor the user has given
ProgrammedPath programmed_path(const ProgramRequest& request, const AxisWords& start);

}  // namespace servomill::sim::limits
