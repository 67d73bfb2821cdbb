/// Approach to and retract from the workpiece along the tool axis.
///
///     start, after a tool change:  Z to the retract height of the machine, rotary axes, X and Y,
///                                  tool length, Z to P + c u, along -u to P
///     end, before a tool change:   along u to P + c u, Z to the retract height
///
/// u is the tool axis, from the tip to the spindle; c the clearance. A rotary axis moves at the
/// retract height only, and near the workpiece the tool moves along its own axis, so that a tilted
/// head does not cut sideways.
///
/// The height is a position of the machine: the block cancels the tool length (G49), since a
/// control may otherwise keep it displayed but not in force after G53 (Fanuc B-63844EN, page 204).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "plant/kinematics/inverse.h"

namespace servomill::controllers {

struct SafeApproachParams {
  double clearance = 10e-3;  // m, c
  double retract_Z = 0.0;    // m, machine coordinate
};

class SafeApproach {
 public:
  /// @param work_offset    work offset (3; m)
  /// @param work_system  1 is G54
  SafeApproach(const plant::InverseKinematics& inverse, const SafeApproachParams& params,
               const Eigen::Vector3d& work_offset, int work_system);

  double clearance() const { return params_.clearance; }

  /// P + c u.
  ToolPose clear_of(const ToolPose& P) const;

  /// Joints at P + c u with the rotary axes of Q, or a fault: beyond the travel, or above the
  /// retract height.
  struct Clear {
    Joints Q = Joints::Zero();
    std::string fault;  // empty: none
  };
  Clear joints_clear_of(const ToolPose& P, const Joints& Q, const Eigen::Vector3d& p_ST) const;

  /// Joints after a retract from Q.
  Joints retracted(Joints Q) const;

  /// "G49 G53 G0 Z400"
  std::string retract_line() const;
  /// "G54 G0 A10 C90", or nothing on a machine without rotary axes.
  std::string rotary_line(const Joints& Q) const;
  /// "G54 G0 X10 Y20": without tool length, at the retract height.
  std::string plane_line(const Joints& Q) const;

 private:
  std::string rapid_line(const Joints& Q, int first, int end) const;

  const plant::InverseKinematics& inverse_;
  SafeApproachParams params_;
  Eigen::Vector3d work_offset_;
  int work_system_;
};

}  // namespace servomill::controllers
