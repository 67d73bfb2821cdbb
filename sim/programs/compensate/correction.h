/// Positions of the axes that put the tool where the program wants it: what a compensated
/// program adds to the programmed position.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/kinematics/chain.h"
#include "plant/vocabulary/axes.h"
#include "strategies/axis_displacement.h"
#include "strategies/path_offset.h"
#include "strategies/pose_compensation.h"

namespace servomill::sim::programs {

/// Directions of travel, one for each axis word: 1 up, -1 down, 0 unknown.
using Directions = std::array<int, kAxisWords>;

/// Identified errors of a machine, with the tool that works.
class Correction {
 public:
  Correction(const plant::MachineChain& chain, const plant::ErrorModel& errors,
             strategies::DisplacedAxes axes);
  Correction(const Correction&) = delete;
  Correction& operator=(const Correction&) = delete;

  /// @param p_ST  tip in the spindle nose (3; m)
  void set_tool(const Eigen::Vector3d& p_ST);
  const Eigen::Vector3d& tool() const { return model_->identified.p_ST; }
  const JointLayout& layout() const { return model_->identified.layout; }

  /// True if errors depend on the direction of travel.
  bool has_reversals() const { return longest_reversal_ > 0.0; }
  /// Axes whose errors do.
  const std::array<bool, kAxisWords>& reverses() const { return reverses_; }
  /// From here on these axes (X, Y, Z) stay where the program puts them.
  void leave(const std::array<bool, kLinearJoints>& axes) { left_ = axes; }

  /// m or rad of travel that a change of direction takes at most
  double longest_reversal() const { return longest_reversal_; }
  /// From here on errors with reversal are those of axes that travel so, long after they turned;
  /// at first, and where the direction is unknown, the mean of both.
  void set_directions(const Directions& directions);
  /// Displacement of the tip between both directions of one axis at a place (m).
  double reversal_at(const AxisWords& machine, Axis axis);

  /// From here on the correction is an offset that was learnt along the path of the program.
  void follow(std::shared_ptr<const strategies::PathOffset> offset);
  bool follows_path() const { return offset_ != nullptr; }
  /// Arc lengths (m) in between at which such an offset has its rows, ascending.
  std::vector<double> rows_between(double s_begin, double s_end) const;

  /// Correction added to the machine coordinates of the program (6; m, rad), so that the machine
  /// with the identified errors puts the tool where the ideal one would: F_ni(Q + d) = F_i(Q).
  AxisWords at(const AxisWords& machine) const;
  /// The same, or the offset that was learnt there.
  /// @param s  m, on the path of the original program
  AxisWords at(const AxisWords& machine, double s) const;

  /// Residual after that correction.
  strategies::Residual residual(const AxisWords& machine) const;

 private:
  struct Model {
    Model(const plant::MachineChain& chain, const plant::ErrorModel& errors);
    strategies::IdentifiedMachine identified;
    strategies::PoseCompensation all;
  };

  AxisWords without_left(AxisWords d) const;

  plant::MachineChain chain_;
  plant::ErrorModel errors_;
  strategies::DisplacedAxes axes_;
  std::array<bool, kAxisWords> reverses_{};  // axes whose errors have reversals
  double longest_reversal_ = 0.0;
  Directions directions_{};
  std::array<bool, kLinearJoints> left_{};
  std::map<Directions, std::unique_ptr<Model>> models_;
  Model* model_ = nullptr;                                // of the directions
  std::shared_ptr<const strategies::PathOffset> offset_;  // along the path; nullptr: of the errors
};

/// Shares of an arc at which the direction of travel of one of these machine axes changes, 0 and 1
/// included.
/// @param x, y  unit vectors of the arc's plane in machine coordinates (3)
/// @param angle, sweep  rad
std::vector<double> shares_between_reversals(const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                                             double angle, double sweep,
                                             const std::array<bool, kAxisWords>& axes);

}  // namespace servomill::sim::programs
