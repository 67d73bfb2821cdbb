/// Errors on one line per axis: all that tables over single axes can hold of a machine's errors.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "plant/geometry/error_model.h"
#include "plant/kinematics/chain.h"
#include "strategies/strategy.h"

namespace servomill::sim::tables {

/// A machine, its errors, and the point from which the lines of all tables start, one along each
/// axis.
struct TableSource {
  plant::MachineChain chain;
  plant::ErrorModel errors;
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // m, tool tip at the spindle nose
  Joints reference = Joints::Zero();               // m, rad; where the other axes stand
};

/// A component error with its axis at q (m, rad) and the others at the reference (m, rad).
/// @param direction  of travel of its axis: 1 up, -1 down, 0 the mean of both
double component_on_line(const TableSource& source, const plant::ErrorName& name, double q,
                         double direction = 0.0);

/// Displacements of the axes that remove the errors on those lines. They are zero at the reference,
/// so that nothing jumps when the tables are switched on; what the machine is off there is a shift
/// of its zero, base(), which a work offset takes.
///
/// Laws, for a machine with three linear axes:
///   (1) on the line of a linear axis j:  F_ni(Q + base() + over(j, Q_j)) = F_i(Q), of the tip, for
///       errors without positioning of the rotary axes
///   (2) for a rotary axis j with no error but its positioning: the same of tip and tool axis, for
///       all Q
class LineCorrection {
 public:
  explicit LineCorrection(const TableSource& source);

  /// @param joint  the axis whose position the table looks up
  /// @param q      its position (m, rad)
  /// @param direction  of travel of the joint: 1 up, -1 down, 0 the mean of both
  /// @return displacement of all axes (5; m, rad) since the reference: of X, Y and Z for a linear
  ///         axis, of itself for a rotary one
  Joints over(int joint, double q, int direction = 0) const;

  /// Returns true if an error of the axis of that joint depends on its direction of travel.
  bool depends_on_direction(int joint) const;

  /// Displacement at the reference (5; m, rad).
  const Joints& base() const { return base_; }

 private:
  // Identified machine without the positioning errors of rotary axes. A joint whose errors depend
  // on the direction of travel has one for each direction.
  strategies::IdentifiedMachine identified_of(const plant::ErrorModel& errors) const;
  const strategies::IdentifiedMachine& identified(int joint, int direction) const;
  Eigen::Vector3d linear_at(const strategies::IdentifiedMachine& identified,
                            const Joints& Q) const;            // m
  double rotary_at(int joint, double q, int direction) const;  // rad

  TableSource source_;
  strategies::IdentifiedMachine identified_;
  std::array<std::array<std::optional<strategies::IdentifiedMachine>, 2>, kLinearJoints> directed_;
  Joints base_ = Joints::Zero();
};

}  // namespace servomill::sim::tables
