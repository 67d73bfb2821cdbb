#include "plant/kinematics/linear_joints.h"

#include <gtest/gtest.h>

#include <limits>

#include "plant/vocabulary/units.h"

namespace servomill::plant::linear_joints_test {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 1e-12;  // m, of some products of coordinates below 1 m

MachineChain chain_of(std::string_view text) { return make_chain(parse_structure(text)); }

TEST(LinearJoints, AreThoseOfTheChainForEveryTip) {
  const Vector3d p_ST{0.01, 0.02, -0.1};
  for (const auto* text : {"[w C' B' X b Y Z t]", "[w b X Y Z A C t]", "[w Y' b X Z t]"}) {
    MachineChain chain = chain_of(text);
    for (ChainAxis& axis : chain.axes) axis.centre = {0.2, -0.1, 0.7};
    for (const double angle : {0.0, 0.3, -90.0 * deg, 2.0}) {
      const Joints Q_rotary{0.0, 0.0, 0.0, angle, -0.5 * angle};
      const TipOfLinearJoints tip = tip_of_linear_joints(chain, Q_rotary, p_ST);
      for (const Vector3d& p : {Vector3d(0.1, -0.2, 0.3), Vector3d(-0.4, 0.0, 0.5)}) {
        const LinearJoints one = linear_joints(chain, p, Q_rotary, p_ST);
        const LinearJoints many = linear_joints(chain, tip, p, Q_rotary);
        EXPECT_EQ(one.Q, many.Q) << text;
        EXPECT_EQ(one.miss, many.miss) << text;
        EXPECT_LT((forward(chain, many.Q, p_ST).p_WT - p).norm(), kRounding) << text;
      }
    }
  }
}

TEST(LinearJoints, MoveTheTipAlongTheAxesWhereNoneIsTurned) {
  const MachineChain chain = chain_of("[w C' B' X b Y Z t]");
  const Vector3d p_ST{0.0, 0.0, -0.1};
  const TipOfLinearJoints tip = tip_of_linear_joints(chain, Joints::Zero(), p_ST);
  EXPECT_TRUE(tip.is_plain);
  EXPECT_EQ(tip.tip, p_ST);
  const Joints turned{0.0, 0.0, 0.0, 0.0, 0.1};
  EXPECT_FALSE(tip_of_linear_joints(chain, turned, p_ST).is_plain);
  const MachineChain without_y = chain_of("[w b X Z t]");
  EXPECT_FALSE(tip_of_linear_joints(without_y, Joints::Zero(), p_ST).is_plain);
}

TEST(LinearJoints, AreNotFoundForATipThatIsNoNumber) {
  const MachineChain chain = chain_of("[w C' B' X b Y Z t]");
  const TipOfLinearJoints tip = tip_of_linear_joints(chain, Joints::Zero(), Vector3d::Zero());
  const Vector3d nowhere{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};
  EXPECT_FALSE(inverse_fixed_rotary(chain, tip, nowhere, Joints::Zero()));
}

}  // namespace
}  // namespace servomill::plant::linear_joints_test
