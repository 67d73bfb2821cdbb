/// The program of a case as the NC of its machine reads it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "controllers/gcode/program_setup.h"
#include "controllers/gcode/program_text.h"
#include "controllers/gcode/tool_table.h"
#include "controllers/path/path_limits.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/move_list.h"
#include "sim/model/forward.h"

namespace servomill::sim::preparation {

/// Text of the original program; it shares the memory of the scenario's.
controllers::ProgramText program_text(const model::ProgramSpec& program);

/// Start of the program in machine coordinates (m, rad).
AxisWords machine_start(const model::Scenario& scenario, const model::CaseSpec& spec);

/// Settings with which the NC reads the program: parameters, work offset, tools, start,
/// subroutines.
controllers::ProgramSetup program_setup(const model::Scenario& scenario,
                                        const model::CaseSpec& spec);

/// Interprets the program of a case as its machine would (work offset, tools, parameters).
/// @param warnings  receives what the NC put right; may be nullptr
/// @param probed    makes what probing moves meet, anew for each reading; empty: nothing is known
/// @throws InputError with all faults of the program
MoveList read_program(const model::Scenario& scenario, const model::CaseSpec& spec,
                      std::vector<Fault>* warnings = nullptr,
                      const std::function<std::shared_ptr<controllers::Probed>()>& probed = {});

/// Nominal kinematics and travel with which the NC of a machine does TCP control.
std::shared_ptr<const controllers::ToolCentrePoint> tool_centre_point(
    const model::MachineSettings& machine);

/// p_ST (3; m) by number of tool offset, of those that the moves use.
std::map<int, Eigen::Vector3d> tips_of(const MoveList& moves, const controllers::ToolTable& tools);

/// Tolerances and overrides with which the NC plans a program.
controllers::PathOptions path_options(const model::NcSettings& nc, double feed_override);

}  // namespace servomill::sim::preparation
