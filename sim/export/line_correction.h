/// What tables over single axes can know of a machine's errors: those on one line per axis.
#pragma once

#include <Eigen/Core>

#include "plant/geometry/error_model.h"
#include "plant/kinematics/chain.h"
#include "strategies/strategy.h"

namespace servomill::sim {

/// A machine, its errors, and the point from which the lines of all tables start, one along each
/// axis.
struct TableSource {
  plant::MachineChain chain;
  plant::ErrorModel errors;
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // m, tool tip at the spindle nose
  Joints reference = Joints::Zero();               // m, rad; where the other axes stand
};

/// Displacements of the axes that remove the errors on those lines.
///
/// Laws, for a machine with three linear axes:
///   (1) on the line of a linear axis j:   F_ni(Q + sum of over(i, Q_i)) = F_i(Q), of the tip, for
///       all rotary axes at the reference and errors without positioning of the rotary axes
///   (2) for a rotary axis j that alone has a positioning error: the same of tip and tool axis, for
///       all Q
class LineCorrection {
 public:
  explicit LineCorrection(const TableSource& source);

  /// @param joint  the axis whose position the table looks up
  /// @param q      its position (m, rad)
  /// @return displacement of all axes (5; m, rad). Of a linear axis: its own is that on its line,
  ///         those of the two others are what changes since the reference, so that the sum over all
  ///         axes counts the error at the reference once. Of a rotary axis: its own only.
  Joints over(int joint, double q) const;

 private:
  Eigen::Vector3d at(const Joints& Q) const;

  TableSource source_;
  strategies::Belief belief_;  // without the positioning errors of rotary axes
  Eigen::Vector3d base_;       // m, at the reference
};

}  // namespace servomill::sim
