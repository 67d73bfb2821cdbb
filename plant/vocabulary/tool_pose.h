/// Pose of the tool in a frame.
#pragma once

#include <Eigen/Core>

namespace servomill {

/// Tool centre point and tool axis, both in the workpiece frame W unless said otherwise.
struct ToolPose {
  Eigen::Vector3d p_WT = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d k_W = Eigen::Vector3d::UnitZ();  // unit vector from the tip to the spindle
};

}  // namespace servomill
