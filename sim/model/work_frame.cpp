#include "sim/model/work_frame.h"

#include <fmt/format.h>

#include "plant/kinematics/chain.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::model {

PartFrame work_frame(const plant::MachineChain& chain, const AxisWords& work_offset) {
  const Joints Q_0 = chain.layout.joints(work_offset);
  return {plant::R_WM(chain, Q_0), plant::forward(chain, Q_0, Eigen::Vector3d::Zero()).p_WT};
}

std::string program_words(const Eigen::Vector3d& p_G) {
  return fmt::format("X{:g} Y{:g} Z{:g}", p_G.x() / mm, p_G.y() / mm, p_G.z() / mm);
}

}  // namespace servomill::sim::model
