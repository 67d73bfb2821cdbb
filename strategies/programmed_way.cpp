#include "strategies/programmed_way.h"

#include "plant/kinematics/straight_tool_path.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::strategies {

ProgrammedWay::ProgrammedWay(const plant::InverseKinematics& inverse, const Eigen::Vector3d& p_ST,
                             const Joints& Q_begin, const Move& move)
    : inverse_(inverse), p_ST_(p_ST), line_(move.line), control_(move.tool_control) {
  if (control_ == ToolControl::work_plane) {
    throw InputError({{}, line_, 0}, "moves in a tilted work plane cannot be rewritten");
  }
  AxisWords begin = layout().words(Q_begin);
  Q_end_ = layout().joints(move.end_machine);
  const ToolPose pose = plant::forward(inverse.chain(), Q_begin, p_ST);
  if (controls_tip()) begin.head<3>() = pose.p_WT;
  curve_ = MoveCurve(begin, move);
  k_begin_ = pose.k_W;
  k_end_ = move.tool_axis;
  if (controls_tip()) Q_end_ = with_tip(move.end_machine.head<3>(), Q_end_);
  turn_ = (Q_end_ - Q_begin).tail<kJoints - kLinearJoints>();
}

Joints ProgrammedWay::at(double t, const Joints& Q_near) const {
  if (t >= 1.0) return Q_end_;
  const AxisWords words = curve_.at(t);
  if (!controls_tip()) return layout().joints(words);
  if (!turns_axis()) return with_tip(words.head<3>(), layout().joints(words));
  const plant::StraightToolPath circle({Eigen::Vector3d::Zero(), k_begin_},
                                       {Eigen::Vector3d::Zero(), k_end_});
  return inverse_.nearest({words.head<3>(), circle.at(t).k_W}, p_ST_, Q_near).Q;
}

Joints ProgrammedWay::with_tip(const Eigen::Vector3d& p_WT, const Joints& Q_rotary) const {
  const auto Q = plant::inverse_fixed_rotary(inverse_.chain(), p_WT, Q_rotary, p_ST_);
  if (!Q) throw InputError({{}, line_, 0}, "the linear axes cannot reach this TCP position");
  return *Q;
}

}  // namespace servomill::strategies
