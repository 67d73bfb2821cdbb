#include "sim/programs/post_kinematics.h"

#include <gtest/gtest.h>

#include <numbers>

#include "plant/kinematics/structure.h"

namespace servomill::sim::programs::post_kinematics_test {
namespace {

constexpr double kExact = 1e-15;  // m: a few roundings

struct Machine {
  plant::MachineChain chain = plant::make_chain(plant::parse_structure("[w C' b X Y Z t]"));
  controllers::PostOptions options;
  PostKinematics kinematics{chain, options};

  Machine() { options.tools = controllers::ToolTable::parse("T1 P1 Z100 D6\n", "tool.tbl"); }

  // A quarter turn of C, and 10 mm along X.
  Move quarter(ToolControl control) const {
    Joints Q = Joints::Zero();
    Q[0] = 10e-3;
    Q[3] = 0.5 * std::numbers::pi;
    Move move;
    move.kind = MoveKind::feed;
    move.tool_control = control;
    move.end_machine = chain.layout.words(Q);
    move.s_end = 10e-3;
    move.feed = 5e-3;
    return move;
  }
};

TEST(PostKinematics, TheTipIsStraightUnderTipControlAlone) {
  const Machine machine;
  PostState now;
  now.tool = 1;
  now.P.p_WT.setZero();
  const Move straight = machine.quarter(ToolControl::rotary_axes);
  const PostBlock block = machine.kinematics.block_of(straight, now);
  EXPECT_LT((machine.kinematics.pose_at(block, 0.5).p_WT - Eigen::Vector3d(5e-3, 0, 0)).norm(),
            kExact);
  const Move joints = machine.quarter(ToolControl::none);
  const PostBlock bent = machine.kinematics.block_of(joints, now);
  const Eigen::Vector3d middle = machine.kinematics.pose_at(bent, 0.5).p_WT;
  EXPECT_NEAR(middle.head<2>().norm(), 5e-3, kExact);
  EXPECT_GT(std::abs(middle[1]), 1e-3);
}

TEST(PostKinematics, BlocksTakeTheirLengthAtTheirFeed) {
  const Machine machine;
  const Move move = machine.quarter(ToolControl::none);
  PostBlock block = machine.kinematics.block_of(move, PostState());
  EXPECT_DOUBLE_EQ(block.time(), 2.0);
  EXPECT_TRUE(block.rotates());
  Move turn = move;
  turn.s_end = 0.0;
  turn.feed = 0.25 * std::numbers::pi;
  block.move = &turn;
  EXPECT_DOUBLE_EQ(block.time(), 2.0);
  block.to = block.from;
  EXPECT_EQ(block.time(), 0.0);
  EXPECT_FALSE(block.rotates());
}

TEST(PostKinematics, AMotionOfXIsNoneOfZ) {
  const Machine machine;
  const Move move = machine.quarter(ToolControl::none);
  PostBlock block = machine.kinematics.block_of(move, PostState());
  EXPECT_FALSE(machine.kinematics.moves_only_Z(block));
  block.to.Q[0] = 0.0;
  EXPECT_TRUE(machine.kinematics.moves_only_Z(block));
}

TEST(PostKinematics, PosesAreEqualToTheDigitsOfThePrograms) {
  ToolPose a, b;
  a.p_WT.setZero();
  a.k_W = Eigen::Vector3d::UnitZ();
  b = a;
  b.p_WT[0] = 0.99 * kPostTip;
  EXPECT_TRUE(same_pose(a, b));
  b.p_WT[0] = 1.01 * kPostTip;
  EXPECT_FALSE(same_pose(a, b));
}

}  // namespace
}  // namespace servomill::sim::programs::post_kinematics_test
