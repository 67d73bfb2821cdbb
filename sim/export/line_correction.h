/// What tables over single axes can know of a machine's errors: those on one line per axis.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

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

/// The positions of one axis over which tables run.
struct TableLine {
  int joint = 0;
  double from = 0.0, to = 0.0;  // m, rad: the travel that must be covered
  double first = 0.0;           // m, rad: of the first point
  double spacing = 1.0;         // m, rad
  std::size_t points = 2;
  bool one_turn = false;  // runs from 0 to 360 deg: entries beyond the travel stand for angles < 0
  bool wraps = false;     // repeats every 360 deg
  bool wanted = true;     // whether tables are made over it

  double entry(std::size_t i) const { return first + static_cast<double>(i) * spacing; }
  /// Position of the axis for which an entry stands.
  double position(double entry) const;
  double entry_of(double position) const;  ///< the way back
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
  /// @param lines  one for each axis of the machine
  LineCorrection(const TableSource& source, const std::vector<TableLine>& lines);

  /// @param joint  the axis whose position the table looks up
  /// @param q      its position (m, rad)
  /// @return displacement of all axes (5; m, rad). Of a rotary axis: its own only. Of a linear
  ///         axis: of X, Y, Z what changes since the reference; what is there already is added for
  ///         an axis to the line of its own, or to the first one wanted, so that the sum over all
  ///         lines counts it once
  Joints over(int joint, double q) const;

 private:
  Eigen::Vector3d at(const Joints& Q) const;

  TableSource source_;
  strategies::Belief belief_;  // without the positioning errors of rotary axes
  Eigen::Vector3d base_;       // m, at the reference
  std::array<int, kLinearJoints> base_line_ = {0, 1, 2};  // that counts it
};

}  // namespace servomill::sim
