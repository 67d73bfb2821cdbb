/// Kinematics of the blocks of a post-processed program that is read back: joints and tool pose
/// along each block, with and without tip control.
#pragma once

#include <Eigen/Core>

#include "controllers/gcode/post_processor.h"
#include "plant/kinematics/chain.h"
#include "plant/vocabulary/move.h"

namespace servomill::sim::programs {

// Words have seven decimals of mm and deg; the tip is up to some metres from a rotary axis.
inline constexpr double kPostTip = 1e-8;    // m
inline constexpr double kPostAxis = 2e-8;   // rad
inline constexpr double kPostJoint = 1e-9;  // m, rad

/// Equal tips and tool axes to the digits of the program.
bool same_pose(const ToolPose& a, const ToolPose& b);

/// State of the machine that a program reaches, block by block.
struct PostState {
  Joints Q = Joints::Zero();
  ToolPose P;
  bool knows_P = false;  // every axis has been named
  bool controls_tip = false;
  int tool = 0, coolant = 0, direction = 0;
  double speed = 0.0;  // rad/s
};

/// One block of motion, from where the machine is.
struct PostBlock {
  const Move* move = nullptr;
  PostState from, to;

  /// A rotary axis moves.
  bool rotates() const;
  /// s, from its length and feed.
  double time() const;
};

class PostKinematics {
 public:
  /// Both outlive it.
  PostKinematics(const plant::MachineChain& chain, const controllers::PostOptions& options)
      : chain_(chain), options_(options) {}

  PostBlock block_of(const Move& move, const PostState& now) const;

  /// Pose at the share t of a block.
  ToolPose pose_at(const PostBlock& block, double t) const;

  /// Neither X nor Y of the machine moves. Under tip control the end of the block is that of the
  /// tip; after it G53 names Z alone.
  bool moves_only_Z(const PostBlock& block) const;

 private:
  Eigen::Vector3d p_ST(int tool) const;

  const plant::MachineChain& chain_;
  const controllers::PostOptions& options_;
};

}  // namespace servomill::sim::programs
