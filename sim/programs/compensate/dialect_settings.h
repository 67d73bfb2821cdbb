/// Settings of the control that a corrected program is written for, from the request and the
/// machine.
#pragma once

#include <array>
#include <optional>

#include "sim/input/machine_description.h"
#include "sim/input/read_machine.h"
#include "sim/programs/compensate/compensate.h"

namespace servomill::sim::programs {

/// Position that programs retract to before and after (Z, machine coordinates, m); absent: nothing
/// names one.
std::optional<double> retract_of(const CompensateRequest& request,
                                 const input::MachineDescription& described);

/// Resolution of positions (m): IS-B and the like; Siemens computes in finer steps than anyone
/// measures.
double resolution_of(const CompensateRequest& request);

/// Rotary axes A, B and C that turn without end.
std::array<bool, 3> endless_axes(const input::MachineDescription& described);

/// All settings of a control other than LinuxCNC.
/// @throws InputError where the request does not go with the control, or lacks what it needs
DialectSettings dialect_settings(const CompensateRequest& request,
                                 const input::MachineDescription& described,
                                 const controllers::ProgramSetup& setup);

}  // namespace servomill::sim::programs
