#include "plant/kinematics/branches.h"

#include <gtest/gtest.h>

#include "tests/plant/kinematics/machine_kinds.h"

namespace servomill::plant::branches_test {
namespace {

constexpr double kRounding = 1e-12;  // m, rad; some products at 1 m
const Eigen::Vector3d kTool(0.0, 0.0, -0.11);

// Machines whose tool axis is in its singular direction at zero.
const std::array<const char*, 3> kUpright = {"[w C' A' b X Y Z t]", "[w C' X b Y Z B t]",
                                             "[w X b Y Z C A t]"};

double way(const Joints& from, const Joints& to) {
  return (to - from).tail<2>().cwiseAbs().maxCoeff();
}

TEST(Departures, AreAllWaysToAPoseWithinTheTravelTheNearestFirst) {
  InverseSettings settings;
  settings.lower.tail<2>() << -110 * deg, -360 * deg;
  settings.upper.tail<2>() << 110 * deg, 360 * deg;
  for (const char* structure : kUpright) {
    const InverseKinematics inverse(make_chain(parse_structure(structure)), settings);
    const Joints Q = Joints::Zero();
    const ToolPose P{forward(inverse.chain(), Q, kTool).p_WT,
                     Eigen::Vector3d(1e-3, 2e-3, 1.0).normalized()};
    const auto found = departures(inverse, P, kTool, Q);
    ASSERT_EQ(found.size(), 4u) << structure << ": two solutions, each with C on either side";
    for (std::size_t i = 0; i < found.size(); ++i) {
      const ToolPose is = forward(inverse.chain(), found[i], kTool);
      EXPECT_LT((is.p_WT - P.p_WT).norm(), kRounding) << structure;
      EXPECT_LT((is.k_W - P.k_W).norm(), kRounding) << structure;
      EXPECT_TRUE(inverse.is_within_travel(found[i])) << structure;
      if (i > 0) {
        EXPECT_LE(way(Q, found[i - 1]), way(Q, found[i])) << structure;
      }
    }
  }
}

TEST(Departures, LeaveOutWhatTheTravelForbids) {
  InverseSettings settings;
  settings.lower.tail<2>() << 0.0, -170 * deg;
  settings.upper.tail<2>() << 110 * deg, 170 * deg;
  const InverseKinematics inverse(make_chain(parse_structure(kUpright[0])), settings);
  const ToolPose P{Eigen::Vector3d::Zero(), Eigen::Vector3d(1e-3, 2e-3, 1.0).normalized()};
  const auto found = departures(inverse, P, kTool, Joints::Zero());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_GT(found[0][3], 0.0) << "A tilts to one side only";
}

TEST(JointAtItsEnd, IsTheOneThatAMotionWouldLeadBeyondItsTravel) {
  InverseSettings settings;
  settings.lower[3] = -10 * deg;
  const InverseKinematics inverse(make_chain(parse_structure(kUpright[0])), settings);
  Joints Q = Joints::Zero(), beyond = Joints::Zero();
  Q[3] = -10 * deg;
  for (const double step : {-0.1 * deg, 0.1 * deg}) {
    beyond[3] = Q[3] + step;
    const ToolPose P = forward(inverse.chain(), beyond, kTool);
    const auto joint = joint_at_its_end(inverse, P, kTool, Q);
    EXPECT_EQ(joint.has_value(), step < 0.0);
    if (joint) {
      EXPECT_EQ(*joint, 3);
    }
  }
}

}  // namespace
}  // namespace servomill::plant::branches_test
