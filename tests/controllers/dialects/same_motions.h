/// Motions of a program as the interpreter and as a verification reader make them.
#pragma once

#include <vector>

#include "controllers/dialects/machine_action.h"
#include "controllers/gcode/program_setup.h"
#include "plant/vocabulary/move.h"

namespace servomill::controllers {

/// The setup of the interpreter for a control.
ProgramSetup setup_of(const ControlSetup& control, Reader reader);

/// Expects the same motions and dwells of both.
/// @return their number
std::size_t expect_same_motions(std::vector<Move> moves, std::vector<MachineAction> actions);

}  // namespace servomill::controllers
