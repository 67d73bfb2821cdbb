// Orientations and positions that a machine cannot reach: its inverse says how far it misses them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "plant/kinematics/inverse.h"
#include "plant/vocabulary/units.h"
#include "tests/plant/kinematics/machine_kinds.h"

namespace servomill::plant::unreachable_test {
namespace {

using Eigen::Vector3d;

constexpr double kRoundTrip = 1e-12;  // m or 1
constexpr double kRounding = 1e-14;   // m or rad: some tens of operations on numbers below 10

MachineChain chain_of(std::string_view text) { return make_chain(parse_structure(text)); }

// k at `tilt` from Z towards the direction `heading` in the XY plane.
Vector3d axis_at(double tilt, double heading) {
  return {std::sin(tilt) * std::cos(heading), std::sin(tilt) * std::sin(heading), std::cos(tilt)};
}

const Vector3d kTip{0.0, 0.0, -0.15};
const Vector3d kOrigin = Vector3d::Zero();

TEST(Unreachable, OrientationBeyondANutatingHead) {
  MachineChain chain = chain_of("[w b X Y Z C B t]");
  incline(chain.at(Axis::B), {0.0, 1.0, 1.0});
  const InverseKinematics inverse(chain);  // 0 to 90 deg
  const Vector3d p{0.1, 0.2, 0.3};
  for (const double beyond : {-1e-6, 0.0, 0.9e-9, 1.1e-9, 0.1}) {
    const JointSolutions s =
        inverse.solve({p, axis_at(90 * deg + beyond, 0.7)}, kTip, Joints::Zero());
    for (const JointSolution& one : s.all) {
      EXPECT_EQ(one.reach, beyond < 1e-9 ? Reach::reached : Reach::orientation) << beyond;
      EXPECT_NEAR(one.miss, one.is_reached() ? 0.0 : beyond, 1e-15) << beyond;
      // and then the nearest that it can do
      const ToolPose P = forward(chain, one.Q, kTip);
      const double tilt = std::min(90 * deg + beyond, 90 * deg);
      EXPECT_LT((P.k_W - axis_at(tilt, 0.7)).norm(), kRoundTrip) << beyond;
      EXPECT_LT((P.p_WT - p).norm(), kRoundTrip) << beyond;
    }
  }
}

TEST(Unreachable, OrientationInsideTheConeThatALeaningTableLeaves) {
  // C leans by 10 deg, B does not: the tool comes no nearer to C than that
  MachineChain chain = chain_of("[w C' B' b X Y Z t]");
  incline(chain.at(Axis::C), {0.0, std::sin(10 * deg), std::cos(10 * deg)});
  const InverseKinematics inverse(chain);
  const Vector3d e_1 = direction_of(chain.at(Axis::C));
  const JointSolution along = inverse.nearest({kOrigin, e_1}, kTip, Joints::Zero());
  EXPECT_EQ(along.reach, Reach::orientation);
  EXPECT_NEAR(along.miss, 10 * deg, kRounding);
  EXPECT_TRUE(inverse.nearest({kOrigin, Vector3d::UnitZ()}, kTip, Joints::Zero()).is_reached());
}

TEST(ThreePlusOne, ReachesTheOrientationsOfItsAxis) {
  const MachineChain chain = chain_of("[w B' b X Y Z t]");
  const InverseKinematics inverse(chain);
  const JointSolutions s = inverse.solve({kOrigin, axis_at(25 * deg, 0.0)}, kTip, Joints::Zero());
  ASSERT_EQ(s.count, 1);
  EXPECT_TRUE(s.nearest().is_reached());
  EXPECT_NEAR(s.nearest().Q[3], 25 * deg, kRounding);
  const JointSolution off = inverse.nearest({kOrigin, {0.0, 0.6, 0.8}}, kTip, Joints::Zero());
  EXPECT_EQ(off.reach, Reach::orientation);
  EXPECT_NEAR(off.miss, std::asin(0.6), kRounding);
}

TEST(ThreePlusOne, TakesTheNearestWithinTheTolerance) {
  InverseSettings settings;
  settings.orientation_tolerance = 1e-5;  // of six decimals in a CL file
  const InverseKinematics inverse(chain_of("[w B' b X Y Z t]"), settings);
  for (const double off : {0.9e-5, 1.1e-5}) {
    const Vector3d k{0.6 * std::cos(off), std::sin(off), 0.8 * std::cos(off)};
    const JointSolution s = inverse.nearest({kOrigin, k}, kTip, Joints::Zero());
    EXPECT_EQ(s.is_reached(), off < 1e-5);
    EXPECT_NEAR(s.Q[3], std::asin(0.6), kRounding);
  }
}

TEST(ThreePlusOne, ARotaryTableUnderAnUprightToolStaysWhereItIs) {
  Joints Q_near = Joints::Zero();
  Q_near[3] = 7.0;
  const JointSolution s = InverseKinematics(chain_of("[w C' b X Y Z t]"))
                              .nearest({{0.1, 0.0, 0.0}, Vector3d::UnitZ()}, kTip, Q_near);
  EXPECT_TRUE(s.is_reached() && s.is_singular);
  EXPECT_EQ(s.Q[3], 7.0);
}

TEST(ThreeAxes, ReachUprightOnly) {
  const InverseKinematics inverse(chain_of("[w X b Y Z t]"));
  const JointSolution s = inverse.nearest({{0.1, 0.2, 0.3}, {0, 0, 1}}, kTip, Joints::Zero());
  EXPECT_TRUE(s.is_reached() && !s.is_singular);
  EXPECT_LT((s.Q.head<3>() - Vector3d(0.1, 0.2, 0.45)).norm(), kRounding);
  EXPECT_EQ(inverse.nearest({kOrigin, axis_at(2e-9, 0.0)}, kTip, Joints::Zero()).reach,
            Reach::orientation);
}

TEST(Unreachable, PositionOfAMachineThatLacksALinearAxis) {
  const InverseKinematics inverse(chain_of("[w X b Y t]"));
  for (const double height : {0.9e-9, 1.1e-9}) {
    const Vector3d p{0.1, 0.2, height};
    const JointSolution s = inverse.nearest({p, {0, 0, 1}}, Vector3d::Zero(), Joints::Zero());
    EXPECT_EQ(s.reach, height < kReachTolerance ? Reach::reached : Reach::position);
    EXPECT_NEAR(s.miss, s.is_reached() ? 0.0 : height, 1e-20);
    EXPECT_LT((s.Q.head<3>() - Vector3d(0.1, 0.2, 0.0)).norm(), kRounding);
  }
}

TEST(Unreachable, WhereTwoLinearAxesAreParallel) {
  const InverseKinematics inverse(chain_of("[w X C b Y Z t]"));
  Joints Q_near = Joints::Zero();
  Q_near[3] = 90 * deg;  // Y now moves along X
  const ToolPose P{kOrigin, Vector3d::UnitZ()};
  EXPECT_EQ(inverse.nearest(P, kTip, Q_near).reach, Reach::parallel_axes);
  Q_near[3] = 89 * deg;
  EXPECT_TRUE(inverse.nearest(P, kTip, Q_near).is_reached());
}

}  // namespace
}  // namespace servomill::plant::unreachable_test
