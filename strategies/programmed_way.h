/// The way of one programmed move, in the joints of the ideal machine.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/kinematics/inverse.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"
#include "plant/vocabulary/move_curve.h"
#include "plant/vocabulary/tool_axis.h"

namespace servomill::strategies {

class ProgrammedWay {
 public:
  /// @param inverse, p_ST  must outlive this
  /// @throws InputError if the move is in a tilted work plane, or the tip cannot get to its end
  ProgrammedWay(const plant::InverseKinematics& inverse, const Eigen::Vector3d& p_ST,
                const Joints& Q_begin, const Move& move);

  bool controls_tip() const { return control_ != ToolControl::none; }
  bool turns_axis() const { return control_ == ToolControl::tool_axis; }
  double length() const { return curve_.length(); }  // m, of X Y Z or of the tip
  const Eigen::Vector2d& turn() const { return turn_; }
  /// rad; the feed refers to it where the tip stands.
  double angle() const { return turns_axis() ? angle_between(k_begin_, k_end_) : turn_.norm(); }
  const Joints& end() const { return Q_end_; }

  /// Joints at a share of the way.
  /// @param Q_near  joints on the way nearby
  Joints at(double t, const Joints& Q_near) const;

  /// rad, by which its direction turns at most: of an arc and of the rotary axes.
  double sweep() const { return curve_.sweep() + turn_.norm(); }

 private:
  const JointLayout& layout() const { return inverse_.chain().layout; }
  Joints with_tip(const Eigen::Vector3d& p_WT, const Joints& Q_rotary) const;

  const plant::InverseKinematics& inverse_;
  const Eigen::Vector3d& p_ST_;
  int line_;
  ToolControl control_;
  MoveCurve curve_;
  Eigen::Vector3d k_begin_, k_end_;
  Joints Q_end_;
  Eigen::Vector2d turn_;
};

}  // namespace servomill::strategies
