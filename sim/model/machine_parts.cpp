#include "sim/model/machine_parts.h"

#include <limits>

#include "sim/model/machine.h"

namespace servomill::sim::model {

const plant::MachineChain& chain_of(const MachineSettings& machine) { return machine.chain; }

const JointLayout& layout_of(const MachineSettings& machine) { return machine.chain.layout; }

const plant::FeedDriveParams& drive_of(const MachineSettings& machine, int joint) {
  return machine.drives[static_cast<std::size_t>(joint)];
}

double base_period_of(const MachineSettings& machine) { return machine.nc.periods.base; }

double current_limit_of(const MachineSettings& machine, int joint) {
  return machine.nc.cascade[static_cast<std::size_t>(joint)].i_max;
}

bool has_heat(const MachineSettings& machine) { return machine.heat != nullptr; }

std::vector<int> joints_of(const MachineSettings& machine) { return machine.joints(); }

std::pair<Joints, Joints> travel_of(const MachineSettings& machine) {
  Joints lower = machine.nc.lower, upper = machine.nc.upper;
  for (int j = 0; j < kJoints; ++j) {
    if (lower[j] < upper[j]) continue;
    lower[j] = -std::numeric_limits<double>::infinity();
    upper[j] = std::numeric_limits<double>::infinity();
  }
  return {lower, upper};
}

}  // namespace servomill::sim::model
