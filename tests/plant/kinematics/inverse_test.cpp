#include "plant/kinematics/inverse.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "tests/plant/kinematics/machine_kinds.h"

namespace servomill::plant::inverse_test {
namespace {

using Eigen::Vector3d;

constexpr double kRoundTrip = 1e-12;  // m or 1, promised by the issue
constexpr double kRounding = 1e-14;   // m or rad: some tens of operations on numbers below 10

MachineChain chain_of(std::string_view text) { return make_chain(parse_structure(text)); }

// k at `tilt` from Z towards the direction `heading` in the XY plane.
Vector3d axis_at(double tilt, double heading) {
  return {std::sin(tilt) * std::cos(heading), std::sin(tilt) * std::sin(heading), std::cos(tilt)};
}

double miss(const MachineChain& chain, const Joints& Q, const Vector3d& p_ST, const ToolPose& P) {
  const ToolPose got = forward(chain, Q, p_ST);
  return std::max((got.p_WT - P.p_WT).norm(), (got.k_W - P.k_W).norm());
}

const MachineChain kTableBC = chain_of("[w C' B' X b Y Z t]");
const MachineChain kTableAC = chain_of("[w C' A' b X Y Z t]");
const Vector3d kTip{0.0, 0.0, -0.15};
const Vector3d kOrigin = Vector3d::Zero();

// --- laws over all kinds of machines ------------------------------------------------------------

TEST(InverseLaws, ForwardOfEverySolutionIsThePose) {
  constexpr int kPoses = 6000;  // of each kind: 10^5 in all
  Uniform random(51);
  for (const Kind& kind : kKinds) {
    for (int n = 0; n < kPoses; ++n) {
      const MachineChain chain = random_chain_of(kind, random);
      const Joints Q = random_joints(chain, random), Q_near = random_joints(chain, random);
      const Vector3d p_ST = 0.2 * random.vector();
      const ToolPose P = forward(chain, Q, p_ST);
      const JointSolutions solutions = InverseKinematics(chain).solve(P, p_ST, Q_near);
      ASSERT_EQ(solutions.count, 2) << kind.name;
      for (const JointSolution& s : solutions.all) {
        ASSERT_TRUE(s.is_reached()) << kind.name << " " << Q.transpose();
        ASSERT_LT(miss(chain, s.Q, p_ST, P), kRoundTrip) << kind.name << " " << Q.transpose();
      }
    }
  }
}

// Also on chains with fewer axes, and with axes that point anywhere: whatever a machine did, it can
// be found again.
TEST(InverseLaws, ForwardOfInverseIsIdentityForEveryStructure) {
  Uniform random(52);
  for (const Structure& structure : all_structures()) {
    for (const bool is_inclined : {false, true}) {
      const MachineChain chain =
          is_inclined ? random_inclined_chain(structure, random) : random_chain(structure, random);
      const Joints Q = random_joints(chain, random);
      const Vector3d p_ST = 0.2 * random.vector();
      const ToolPose P = forward(chain, Q, p_ST);
      const JointSolution s = InverseKinematics(chain).nearest(P, p_ST, Q);
      ASSERT_TRUE(s.is_reached()) << to_string(structure);
      ASSERT_LT(miss(chain, s.Q, p_ST, P), kRoundTrip) << to_string(structure);
    }
  }
}

// Away from where rounding of the tool axis (1e-16) makes large angles.
TEST(InverseLaws, AStandingToolStandsStill) {
  constexpr double kSpread = 0.05;  // 1/rad^2, of the ways that the tool axis goes
  constexpr double kAngle = 1e-13;  // rad, m: 1e-15 over that, and the rounding of some turns
  Uniform random(53);
  for (const Kind& kind : kKinds) {
    int counted = 0;
    for (int n = 0; n < 1000; ++n) {
      const MachineChain chain = random_chain_of(kind, random);
      Joints Q = random_joints(chain, random);
      Q[3] *= 10.0;  // many turns
      const Vector3d p_ST = 0.2 * random.vector();
      const PoseJacobian J = jacobian(chain, Q, p_ST);
      if (J.J_kQ.col(3).cross(J.J_kQ.col(4)).norm() < kSpread) continue;
      ++counted;
      const JointSolution s = InverseKinematics(chain).nearest(forward(chain, Q, p_ST), p_ST, Q);
      ASSERT_LT((s.Q - Q).norm(), kAngle) << kind.name << " " << Q.transpose();
    }
    EXPECT_GT(counted, 800) << kind.name;
  }
}

// Grid of directions to the singular one and all around it: no loss of precision.
TEST(InverseLaws, ForwardOfInverseIsThePoseHoweverNearToASingularDirection) {
  Uniform random(54);
  for (const Kind& kind : kKinds) {
    const MachineChain chain = random_chain_of(kind, random);
    const InverseKinematics inverse(chain);
    // here the tool is parallel to the first rotary axis, or as near as it gets
    Joints Q = Joints::Zero();
    for (const ChainAxis& a : chain.axes) {
      if (is_linear(a.axis)) continue;
      const Vector3d e = direction_of(a);
      const JointSolution s = inverse.nearest({0.1 * random.vector(), e}, kTip, Q);
      if (s.is_reached()) Q = s.Q;
      break;
    }
    for (int exponent = -16; exponent <= 0; ++exponent) {
      for (int n = 0; n < 40; ++n) {
        Joints at = Q;
        at.tail<2>() += std::pow(10.0, exponent) * random.vector().head<2>();
        const ToolPose P = forward(chain, at, kTip);
        const JointSolutions all = inverse.solve(P, kTip, at);
        for (int i = 0; i < all.count; ++i) {
          const JointSolution& s = all.all[static_cast<std::size_t>(i)];
          ASSERT_TRUE(s.is_reached()) << kind.name << " 1e" << exponent;
          ASSERT_LT(miss(chain, s.Q, kTip, P), 2.0 * kRoundTrip) << kind.name << " 1e" << exponent;
        }
      }
    }
  }
}

// --- both solutions -----------------------------------------------------------------------------

TEST(BothSolutions, OfOrthogonalAxesAreMirrored) {
  const InverseKinematics inverse(kTableBC);
  const ToolPose P{{0.1, 0.2, 0.3}, axis_at(30 * deg, 50 * deg)};
  const JointSolutions s = inverse.solve(P, kTip, Joints::Zero());
  ASSERT_EQ(s.count, 2);
  EXPECT_NEAR(s.all[0].Q[3], 30 * deg, kRounding);
  EXPECT_NEAR(s.all[0].Q[4], 50 * deg, kRounding);
  EXPECT_NEAR(s.all[1].Q[3], -30 * deg, kRounding);
  EXPECT_NEAR(s.all[1].Q[4], -130 * deg, kRounding);
}

TEST(BothSolutions, TheOneThatTurnsLessComesFirst) {
  const InverseKinematics inverse(kTableBC);
  const ToolPose P{{0.1, 0.2, 0.3}, axis_at(30 * deg, 50 * deg)};
  Joints Q_near = Joints::Zero();
  Q_near.tail<2>() << 0.0, -41 * deg;  // 91 or 89 deg from there
  const JointSolutions s = inverse.solve(P, kTip, Q_near);
  EXPECT_NEAR(s.all[0].Q[4], -130 * deg, kRounding);
  EXPECT_NEAR(s.all[1].Q[4], 50 * deg, kRounding);
}

TEST(BothSolutions, OfANutatingHeadLieOnBothSidesOfItsHighestPoint) {
  // k_z = cos^2 + sin^2 cos(q) with half a right angle: q = acos(2 k_z - 1)
  MachineChain chain = chain_of("[w b X Y Z C B t]");
  incline(chain.at(Axis::B), {0.0, 1.0, 1.0});
  const double tilt = 30 * deg;
  const JointSolutions s =
      InverseKinematics(chain).solve({kOrigin, axis_at(tilt, 0.2)}, kTip, Joints::Zero());
  ASSERT_EQ(s.count, 2);
  const double B = std::acos(2.0 * std::cos(tilt) - 1.0);
  EXPECT_NEAR(std::abs(s.all[0].Q[3]), B, kRounding);
  EXPECT_NEAR(s.all[0].Q[3], -s.all[1].Q[3], kRounding);
}

TEST(BothSolutions, AgreeWithTheDualRotaryTableOfLi) {
  // Li 2024: A = acos(k_z), C = atan2(k_x, k_y), as the table counts
  MachineChain chain = kTableAC;
  for (const Axis a : {Axis::A, Axis::C}) chain.at(a).sense = Sense::table;
  Uniform random(55);
  for (int n = 0; n < 100; ++n) {
    const Vector3d u = random.vector().normalized();
    const JointSolutions s =
        InverseKinematics(chain).solve({0.1 * random.vector(), u}, kTip, Joints::Zero());
    const JointSolution& up = s.all[s.all[0].Q[3] > 0.0 ? 0 : 1];
    EXPECT_NEAR(up.Q[3], std::acos(u.z()), kRounding);
    EXPECT_NEAR(up.Q[4], std::atan2(u.x(), u.y()), kRounding);
  }
}

// --- continuity and travel ----------------------------------------------------------------------

TEST(Continuity, CTurnsThrough180DegAndOnWithoutAJump) {
  const InverseKinematics inverse(kTableBC);
  Joints at = Joints::Zero();
  at[3] = 30 * deg;
  for (int n = 0; n <= 1500; ++n) {  // about four turns
    const double heading = n * deg;
    at = inverse.nearest({{0.1, 0.2, 0.3}, axis_at(30 * deg, heading)}, kTip, at).Q;
    ASSERT_NEAR(at[4], heading, 1e-13) << n;
    ASSERT_NEAR(at[3], 30 * deg, kRounding);
  }
}

TEST(Continuity, AcrossASingularDirectionTheToolTiltsOn) {
  const InverseKinematics inverse(kTableBC);
  Joints at = Joints::Zero();
  at.tail<2>() << 5 * deg, 70 * deg;
  for (int n = -50; n <= 50; ++n) {
    const double tilt = -0.1 * n * deg;
    const JointSolution s = inverse.nearest({kOrigin, axis_at(tilt, 70 * deg)}, kTip, at);
    ASSERT_EQ(s.is_singular, n == 0);
    at = s.Q;
    ASSERT_NEAR(at[3], tilt, kRounding) << n;
    ASSERT_NEAR(at[4], 70 * deg, 1e-12) << n;  // 1e-16 over the least tilt
  }
}

InverseSettings travel_of(int joint, double lower, double upper) {
  InverseSettings settings;
  settings.lower[joint] = lower;
  settings.upper[joint] = upper;
  return settings;
}

TEST(Travel, DecidesBetweenTheSolutions) {
  const ToolPose P{kOrigin, axis_at(30 * deg, 50 * deg)};
  const InverseKinematics inverse(kTableBC, travel_of(3, -110 * deg, 10 * deg));
  const JointSolutions s = inverse.solve(P, kTip, Joints::Zero());
  EXPECT_TRUE(s.all[0].is_reached());
  EXPECT_NEAR(s.all[0].Q[3], -30 * deg, kRounding);
  EXPECT_EQ(s.all[1].reach, Reach::travel);
  EXPECT_EQ(s.all[1].joint, 3);
  EXPECT_NEAR(s.all[1].miss, 20 * deg, kRounding);
}

TEST(Travel, OfALinearAxisDecidesAsWell) {
  const ToolPose P{{0.3, 0.0, 0.1}, axis_at(30 * deg, 0.0)};
  const JointSolutions free = InverseKinematics(kTableBC).solve(P, kTip, Joints::Zero());
  const double x_0 = free.all[0].Q[0], x_1 = free.all[1].Q[0];
  ASSERT_GT(x_0, x_1 + 0.1);
  const InverseKinematics inverse(kTableBC, travel_of(0, -1.0, 0.5 * (x_0 + x_1)));
  const JointSolutions s = inverse.solve(P, kTip, Joints::Zero());
  EXPECT_EQ(s.all[0].Q, free.all[1].Q);
  EXPECT_EQ(s.all[1].reach, Reach::travel);
  EXPECT_EQ(s.all[1].joint, 0);
}

TEST(Travel, MayAskForAFullTurnBack) {
  const InverseKinematics inverse(kTableBC, travel_of(4, -200 * deg, 200 * deg));
  Joints Q_near = Joints::Zero();
  Q_near.tail<2>() << 30 * deg, 199 * deg;
  const JointSolution within =
      inverse.nearest({kOrigin, axis_at(30 * deg, 199.5 * deg)}, kTip, Q_near);
  EXPECT_NEAR(within.Q[4], 199.5 * deg, kRounding);
  const JointSolutions beyond =
      inverse.solve({kOrigin, axis_at(30 * deg, 201 * deg)}, kTip, Q_near);
  for (const JointSolution& s : beyond.all) {  // 201 - 360 with B = 30, 201 - 180 with B = -30
    EXPECT_TRUE(s.is_reached());
    EXPECT_NEAR(s.Q[4], (s.Q[3] > 0.0 ? -159 : 21) * deg, kRounding);
  }
}

TEST(Travel, IsNoLongerThanItsTolerance) {
  InverseSettings settings = travel_of(3, -30 * deg, 30 * deg);
  for (const double beyond : {0.9e-9, 1.1e-9}) {
    const InverseKinematics inverse(kTableBC, settings);
    const JointSolution s =
        inverse.nearest({kOrigin, axis_at(30 * deg + beyond, 0.0)}, kTip, Joints::Zero());
    EXPECT_EQ(s.is_reached(), beyond < settings.travel_tolerance);
  }
}

TEST(Travel, OfLessThanATurnThatHoldsNoSolutionIsReported) {
  const InverseKinematics inverse(kTableBC, travel_of(4, -20 * deg, 20 * deg));
  const JointSolutions s =
      inverse.solve({kOrigin, axis_at(30 * deg, 50 * deg)}, kTip, Joints::Zero());
  EXPECT_EQ(s.all[0].reach, Reach::travel);
  EXPECT_EQ(s.all[1].reach, Reach::travel);
  EXPECT_NEAR(s.nearest().miss, 30 * deg, kRounding);
}

// --- singular directions ------------------------------------------------------------------------

TEST(Singular, FreeAngleStaysWhereItIs) {
  const InverseKinematics inverse(kTableAC);
  Joints Q_near = Joints::Zero();
  Q_near.tail<2>() << 10 * deg, 400 * deg;
  const JointSolutions s = inverse.solve({{0.1, 0.2, 0.3}, Vector3d::UnitZ()}, kTip, Q_near);
  ASSERT_EQ(s.count, 1);
  EXPECT_TRUE(s.nearest().is_reached());
  EXPECT_TRUE(s.nearest().is_singular);
  EXPECT_EQ(s.nearest().Q[4], 400 * deg);
  EXPECT_NEAR(s.nearest().Q[3], 0.0, kRounding);
  EXPECT_LT((forward(kTableAC, s.nearest().Q, kTip).p_WT - Vector3d(0.1, 0.2, 0.3)).norm(),
            kRoundTrip);
}

TEST(Singular, DownsideOfTheTableIsSingularToo) {
  const InverseKinematics inverse(kTableAC);
  Joints Q_near = Joints::Zero();
  Q_near.tail<2>() << 170 * deg, 33 * deg;
  const JointSolution s = inverse.nearest({kOrigin, -Vector3d::UnitZ()}, kTip, Q_near);
  EXPECT_TRUE(s.is_singular);
  EXPECT_EQ(s.Q[4], 33 * deg);
  EXPECT_NEAR(s.Q[3], 180 * deg, kRounding);
}

TEST(Singular, WithinTheToleranceTheAngleIsKeptAndTheAxisMissedByNoMore) {
  InverseSettings settings;
  settings.singular_angle = 1e-4;
  const InverseKinematics inverse(kTableBC, settings);
  for (const double tilt : {0.9e-4, 1.1e-4}) {
    const Vector3d k = axis_at(tilt, 90 * deg);
    const JointSolution s = inverse.nearest({kOrigin, k}, kTip, Joints::Zero());
    const double missed = (forward(kTableBC, s.Q, kTip).k_W - k).norm();
    EXPECT_TRUE(s.is_reached());
    EXPECT_EQ(s.is_singular, tilt < settings.singular_angle);
    EXPECT_NEAR(std::abs(s.Q[4]), tilt < settings.singular_angle ? 0.0 : 90 * deg, kRoundTrip);
    EXPECT_NEAR(missed, tilt < settings.singular_angle ? tilt : 0.0, 1e-3 * tilt);
  }
}

TEST(Singular, AHeadWhoseLastAxisIsItsSpindleIsSingularEverywhere) {
  const MachineChain chain = chain_of("[w b X Y Z B C t]");  // C turns the tool about itself
  Joints Q_near = Joints::Zero();
  Q_near[4] = 2.0;
  const JointSolutions s =
      InverseKinematics(chain).solve({kOrigin, axis_at(40 * deg, 0.0)}, kTip, Q_near);
  ASSERT_EQ(s.count, 1);
  EXPECT_TRUE(s.nearest().is_reached() && s.nearest().is_singular);
  EXPECT_NEAR(s.nearest().Q[3], 40 * deg, kRounding);
  EXPECT_EQ(s.nearest().Q[4], 2.0);
  // out of the plane of B there is nothing
  const JointSolution out =
      InverseKinematics(chain).nearest({kOrigin, axis_at(40 * deg, 1 * deg)}, kTip, Q_near);
  EXPECT_EQ(out.reach, Reach::orientation);
}

TEST(Singular, TwoParallelAxesShareTheTurn) {
  MachineChain chain = chain_of("[w C' B' b X Y Z t]");
  incline(chain.at(Axis::B), Vector3d::UnitX());
  incline(chain.at(Axis::C), Vector3d::UnitX());
  Joints Q_near = Joints::Zero();
  Q_near.tail<2>() << 10 * deg, 20 * deg;
  const JointSolution s =
      InverseKinematics(chain).nearest({kOrigin, axis_at(-50 * deg, 90 * deg)}, kTip, Q_near);
  EXPECT_TRUE(s.is_reached() && s.is_singular);
  EXPECT_EQ(s.Q[4], 20 * deg);
  EXPECT_NEAR(s.Q[3], 30 * deg, kRounding);
}

TEST(Singular, DistanceIsTheAngleToTheFirstAxis) {
  const InverseKinematics inverse(kTableBC);
  EXPECT_NEAR(inverse.distance_from_singular(axis_at(20 * deg, 1.0)), 20 * deg, kRounding);
  EXPECT_NEAR(inverse.distance_from_singular(axis_at(150 * deg, 1.0)), 30 * deg, kRounding);
  EXPECT_EQ(InverseKinematics(chain_of("[w B' b X Y Z t]")).distance_from_singular({0, 0, 1}),
            90 * deg);
  EXPECT_EQ(InverseKinematics(chain_of("[w b X B C t]")).distance_from_singular({0, 0, 1}), 0.0);
}

}  // namespace
}  // namespace servomill::plant::inverse_test
