#include "sim/programs/post_kinematics.h"

#include "plant/kinematics/inverse.h"

namespace servomill::sim::programs {

using Eigen::Vector3d;

bool same_pose(const ToolPose& a, const ToolPose& b) {
  return (a.p_WT - b.p_WT).norm() <= kPostTip && angle_between(a.k_W, b.k_W) <= kPostAxis;
}

bool PostBlock::rotates() const {
  return (to.Q - from.Q).tail<kJoints - kLinearJoints>().cwiseAbs().maxCoeff() > kPostJoint;
}

double PostBlock::time() const {
  const double length = move->s_end - move->s_begin;
  const double way = length > 0.0 ? length : (to.Q - from.Q).tail<kJoints - kLinearJoints>().norm();
  return way > 0.0 ? way / move->feed : 0.0;
}

Vector3d PostKinematics::p_ST(int number) const {
  const auto* tool = options_.tools.find(number);
  return tool == nullptr ? Vector3d::Zero() : Vector3d(-tool->offset.head<3>());
}

PostBlock PostKinematics::block_of(const Move& move, const PostState& now) const {
  PostBlock block{&move, now, now};
  block.to.controls_tip = move.tool_control != ToolControl::none;
  const Joints end = chain_.layout.joints(move.end_machine);
  if (block.to.controls_tip) {
    block.to.Q.tail<kJoints - kLinearJoints>() = end.tail<kJoints - kLinearJoints>();
    block.to.P = {move.end_machine.head<3>(),
                  plant::forward(chain_, block.to.Q, p_ST(now.tool)).k_W};
  } else {
    block.to.Q = end;
    block.to.P = plant::forward(chain_, end, p_ST(now.tool));
  }
  return block;
}

ToolPose PostKinematics::pose_at(const PostBlock& block, double t) const {
  const Joints Q = block.from.Q + t * (block.to.Q - block.from.Q);
  ToolPose pose = plant::forward(chain_, Q, p_ST(block.from.tool));
  if (!block.to.controls_tip) return pose;
  return {block.from.P.p_WT + t * (block.to.P.p_WT - block.from.P.p_WT), pose.k_W};
}

bool PostKinematics::moves_only_Z(const PostBlock& block) const {
  if (block.from.controls_tip) return true;
  Joints end = block.to.Q;
  double tolerance = kPostJoint;
  if (block.to.controls_tip) {
    const auto found =
        plant::inverse_fixed_rotary(chain_, block.to.P.p_WT, end, p_ST(block.from.tool));
    if (!found) return false;
    end = *found;
    tolerance = kPostTip;
  }
  return (end - block.from.Q).head<2>().cwiseAbs().maxCoeff() <= tolerance;
}

}  // namespace servomill::sim::programs
