#include "sim/work_frame.h"

namespace servomill::sim {

PartFrame work_frame(const plant::MachineChain& chain, const AxisWords& work_offset) {
  const Joints Q_0 = chain.layout.joints(work_offset);
  return {plant::R_WM(chain, Q_0), plant::forward(chain, Q_0, Eigen::Vector3d::Zero()).p_WT};
}

}  // namespace servomill::sim
