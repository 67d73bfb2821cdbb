/// The tool of an exported machine: where the axes and the geometric errors put it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "plant/geometry/volumetric.h"
#include "sim/fmu/axis_variables.h"
#include "sim/fmu/machine_constants.h"

namespace servomill::sim::fmu {

/// Value reference of the first variable of the tool, behind those of all axes.
inline constexpr std::uint32_t kToolReference = 1000;
inline constexpr std::uint32_t kTipCoordinates = 3;  // the first are parameters, the others outputs
inline constexpr std::uint32_t kToolVariables = 12;

/// Sorted by reference, from kToolReference on without gaps.
std::span<const Variable> tool_variables();

/// In the order of the variables: the tip in the spindle nose (m); tool centre point in the
/// workpiece (m), unit tool axis, and deviation of the tool centre point from that of the ideal
/// machine with its axes at the same positions (m).
using ToolValues = std::array<double, kToolVariables>;

class Tool {
 public:
  explicit Tool(const KinematicConstants& kinematics)
      : model_(kinematics.chain, kinematics.errors) {}

  /// @param Q     positions of slides and tables (5; m, rad)
  /// @param p_ST  tip in the spindle nose (3; m)
  ToolValues values(const Joints& Q, const Eigen::Vector3d& p_ST) const;

 private:
  plant::VolumetricModel model_;
};

}  // namespace servomill::sim::fmu
