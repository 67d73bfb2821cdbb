/// The work frame G of a case: the coordinates in which its program is written, fixed to the
/// workpiece and turning with it.
#pragma once

#include <Eigen/Core>
#include <string>

#include "plant/vocabulary/axes.h"

namespace servomill::plant {
struct MachineChain;  // plant/kinematics/chain.h
}  // namespace servomill::plant

namespace servomill::sim::model {

/// G, in the frame W of the workpiece (plant/kinematics/chain.h). Stock, probes and positions of
/// cutters are given in G; the tip is recorded in W.
struct PartFrame {
  Eigen::Matrix3d R_WG = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p_WG = Eigen::Vector3d::Zero();  // m

  Eigen::Vector3d point(const Eigen::Vector3d& p_W) const {
    return R_WG.transpose() * (p_W - p_WG);
  }
  Eigen::Vector3d direction(const Eigen::Vector3d& v_W) const { return R_WG.transpose() * v_W; }
  Eigen::Vector3d in_workpiece(const Eigen::Vector3d& p_G) const { return R_WG * p_G + p_WG; }
};

/// Tip of the ideal machine for a programmed X Y Z with all rotary words at 0:
///
///     p_W = R_WG (X, Y, Z) + p_WG                                                          (1)
///     R_WG = R_WM(Q_0),  p_WG = p_WT(Q_0) of a tool of no length,  Q_0 the work offset       (2)
///
/// (1) holds for programs that say positions of axes, with the tool length compensated (G43), on
/// machines that move X, Y and Z on the tool side of their rotary tables. Under
/// tool-centre-point control X Y Z count in W whatever the offset of rotary axes: the same frame
/// only where that is zero.
/// @param work_offset  6; m, rad, machine coordinates
PartFrame work_frame(const plant::MachineChain& chain, const AxisWords& work_offset);

/// A place in G as programs say it: "X1 Y2.5 Z-3", in mm.
std::string program_words(const Eigen::Vector3d& p_G);

}  // namespace servomill::sim::model
