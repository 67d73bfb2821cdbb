/// Screw compensation of LinuxCNC: [JOINT_n] COMP_FILE and COMP_FILE_TYPE of an INI file.
#pragma once

#include <span>
#include <vector>

#include "controllers/tables/control_table.h"

namespace servomill::controllers {

/// Tables of all joints.
///
/// Rules (LinuxCNC, INI Configuration, [JOINT_n]; usrmotLoadComp in src/emc/motion/usrmotintf.cc;
/// EMCMOT_SET_JOINT_COMP in command.c; compute_screw_comp in control.c):
///   - a line holds nominal position, value moving up, value moving down, in the units of the joint
///     (mm, deg); reading ends at the first line that is not three numbers
///   - COMP_FILE_TYPE 0: values are positions, and nominal - value is added to the command of the
///     motor; COMP_FILE_TYPE 1: values are added as they are
///   - up to 256 lines of up to 254 characters, nominal positions increase
///   - linear between lines, the trim of the first and the last beyond them
///
/// @param files   one INI file, whose name ends in .ini, and the files that it names
/// @param joints  axis of joint 0, 1, ...
/// @throws InputError with file and line for what LinuxCNC would refuse or not read
std::vector<ControlTable> read_linuxcnc_tables(std::span<const TableText> files,
                                               std::span<const Axis> joints);

}  // namespace servomill::controllers
