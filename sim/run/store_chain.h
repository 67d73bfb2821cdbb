/// The kinematic chain of a case in result files, so that what reads them can move the machine.
#pragma once

#include "plant/kinematics/chain.h"
#include "sim/records/hdf5_group.h"

namespace servomill::sim::run {

/// Attributes of the group of a case, one number or three for each axis, from the workpiece to the
/// tool:
///
///     chain_axes                 letters: "CBXYZ"
///     chain_carries_workpiece    1: the axis stands between bed and workpiece
///     chain_directions           unit vectors in the machine frame M, along which or about which
///                                the tool moves, seen from the workpiece, as the axis counts up
///     chain_points_mm            points of the rotary axes in M
void write_chain(records::Hdf5Group& group, const plant::MachineChain& chain);

}  // namespace servomill::sim::run
