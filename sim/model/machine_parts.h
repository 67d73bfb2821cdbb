/// Accessors to a machine for sources that do not include sim/model/machine.h.
#pragma once

#include <utility>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/model/forward.h"

namespace servomill::plant {
struct FeedDriveParams;  // plant/drives/feed_drive.h
struct MachineChain;     // plant/kinematics/chain.h
}  // namespace servomill::plant

namespace servomill::sim::model {

const plant::MachineChain& chain_of(const MachineSettings& machine);
const JointLayout& layout_of(const MachineSettings& machine);

/// False of a machine that stays at its reference temperature.
bool has_heat(const MachineSettings& machine);

const plant::FeedDriveParams& drive_of(const MachineSettings& machine, int joint);

/// Base period of its loops (s).
double base_period_of(const MachineSettings& machine);

/// Largest current of the drive of a joint (A).
double current_limit_of(const MachineSettings& machine, int joint);

/// Joints that the machine has.
std::vector<int> joints_of(const MachineSettings& machine);

/// Travel (5 and 5; m, rad); infinite for an axis without one.
std::pair<Joints, Joints> travel_of(const MachineSettings& machine);

}  // namespace servomill::sim::model
