/// Where the axes have to stand so that the tool is where the program wants it: what a compensated
/// program adds to the programmed position.
#pragma once

#include <optional>
#include <string>

#include "plant/geometry/error_model.h"
#include "plant/kinematics/chain.h"
#include "plant/vocabulary/axes.h"
#include "strategies/compensation.h"
#include "strategies/pose_compensation.h"

namespace servomill::sim {

/// What is believed of a machine's errors, with the tool that works.
class Correction {
 public:
  Correction(const plant::MachineChain& chain, const plant::ErrorModel& errors,
             strategies::DisplacedAxes axes);
  Correction(const Correction&) = delete;
  Correction& operator=(const Correction&) = delete;

  /// @param p_ST  tip in the spindle nose (3; m)
  void set_tool(const Eigen::Vector3d& p_ST) { belief_.p_ST = p_ST; }
  const Eigen::Vector3d& tool() const { return belief_.p_ST; }
  const JointLayout& layout() const { return belief_.layout; }

  /// What to add to the machine coordinates of the program (6; m, rad), so that the machine with
  /// the believed errors puts the tool where the ideal one would: F_ni(Q + d) = F_i(Q).
  AxisWords at(const AxisWords& machine) const;

  /// What stays then.
  strategies::Leftover leftover(const AxisWords& machine) const;

 private:
  strategies::Belief belief_;
  strategies::DisplacedAxes axes_;
  strategies::PoseCompensation all_;
};

}  // namespace servomill::sim
