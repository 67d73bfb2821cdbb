#include "plant/kinematics/chain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plant/vocabulary/units.h"
#include "tests/plant/kinematics/all_structures.h"

namespace servomill::plant::chain_test {
namespace {

using Eigen::Vector3d;

// Rounding of a few products of coordinates below 1 m, twenty times over.
constexpr double kRounding = 5e-15;   // m or 1
constexpr double kRoundTrip = 1e-12;  // m, promised by the issue

MachineChain chain_of(std::string_view text) { return make_chain(parse_structure(text)); }

TEST(Chain, MultipliesAsItIsRead) {
  const MachineChain chain = chain_of("[w C' B' X b Y Z (C1) t]");
  const double b = 0.4, c = 1.1, L = 0.12;
  const Joints Q{0.1, -0.2, 0.3, b, c};
  const ToolPose P = forward(chain, Q, {0.0, 0.0, -L});
  const double x = 0.1, y = -0.2, z = 0.3 - L;
  const Vector3d p{std::cos(c) * (std::cos(b) * x + std::sin(b) * z) - std::sin(c) * y,
                   std::sin(c) * (std::cos(b) * x + std::sin(b) * z) + std::cos(c) * y,
                   -std::sin(b) * x + std::cos(b) * z};
  EXPECT_LT((P.p_WT - p).norm(), kRounding);
  const Vector3d k{std::sin(b) * std::cos(c), std::sin(b) * std::sin(c), std::cos(b)};
  EXPECT_LT((P.k_W - k).norm(), kRounding);
}

TEST(Chain, SideOfTheBedDoesNotChangeTheIdealMachine) {
  const Joints Q{0.1, -0.2, 0.3, 0.4, 1.1};
  const Vector3d p_ST{0.01, 0.02, -0.1};
  const ToolPose P = forward(chain_of("[w C' B' X' b Y Z t]"), Q, p_ST);
  const ToolPose P_head = forward(chain_of("[w b C B X Y Z t]"), Q, p_ST);
  EXPECT_EQ(P.p_WT, P_head.p_WT);
  EXPECT_EQ(P.k_W, P_head.k_W);
}

TEST(Chain, RotaryAxisTurnsAboutItsCentre) {
  MachineChain chain = chain_of("[w C' b X Y Z t]");
  chain.at(Axis::C).centre = {0.2, -0.1, 0.7};
  Joints Q = Joints::Zero();
  Q.head<3>() = Vector3d{0.2, -0.1, 0.3};
  Q[3] = 2.0;
  EXPECT_LT((forward(chain, Q, Vector3d::Zero()).p_WT - Vector3d(0.2, -0.1, 0.3)).norm(),
            kRounding);
  Q[0] += 0.05;
  EXPECT_LT((forward(chain, Q, Vector3d::Zero()).p_WT -
             Vector3d(0.2 + 0.05 * std::cos(2.0), -0.1 + 0.05 * std::sin(2.0), 0.3))
                .norm(),
            kRounding);
}

TEST(Chain, OrientationOfTheBedComesFromTheWorkpieceSideOnly) {
  const Joints Q{0.0, 0.0, 0.0, 0.4, 1.1};
  const MachineChain split = chain_of("[w C' X b Y B Z t]");
  EXPECT_LT((R_WM(split, Q) * Vector3d::UnitX() - Vector3d(std::cos(1.1), std::sin(1.1), 0)).norm(),
            kRounding);
  EXPECT_EQ(R_WM(chain_of("[w b C B X Y Z t]"), Q), Eigen::Matrix3d::Identity());
}

// Li 2024, corrected inverse kinematics of a dual rotary table: S is where the linear axes
// go.
TEST(Chain, AgreesWithTheDualRotaryTableOfLi) {
  MachineChain chain = chain_of("[w C' A' b X Y Z t]");
  const Vector3d m{0.02, -0.03, -0.15};
  for (const Axis a : {Axis::A, Axis::C}) {
    chain.at(a).centre = m;
    chain.at(a).sense = Sense::table;
  }
  Uniform random(20241);
  for (int i = 0; i < 100; ++i) {
    const Vector3d P = 0.2 * random.vector(), u = random.vector().normalized();
    const double A = std::atan2(std::hypot(u.x(), u.y()), u.z()), C = std::atan2(u.x(), u.y());
    const Vector3d d = P - m;
    const double e = std::sin(C) * d.x() + std::cos(C) * d.y();
    Joints Q{std::cos(C) * d.x() - std::sin(C) * d.y() + m.x(),
             std::cos(A) * e - std::sin(A) * d.z() + m.y(),
             std::sin(A) * e + std::cos(A) * d.z() + m.z(), A, C};
    const ToolPose posed = forward(chain, Q, Vector3d::Zero());
    EXPECT_LT((posed.p_WT - P).norm(), kRounding);
    EXPECT_LT((posed.k_W - u).norm(), kRounding);
    const auto back = inverse_fixed_rotary(chain, P, Q, Vector3d::Zero());
    ASSERT_TRUE(back);
    EXPECT_LT((*back - Q).norm(), kRoundTrip);
  }
}

// Li 2024, example 1 with the centre at the origin: joints interpolated linearly between the
// two posts leave the chord by 0.156 mm.
TEST(Chain, BendsTheFirstSegmentOfLiAsJointInterpolationDoes) {
  MachineChain chain = chain_of("[w C' A' b X Y Z t]");
  for (const Axis a : {Axis::A, Axis::C}) chain.at(a).sense = Sense::table;
  const Vector3d P_0 = Vector3d(-191.4037, 11.3508, 7.6182) * mm;
  const Vector3d P_1 = Vector3d(-191.4057, 13.5159, 7.9093) * mm;
  const auto post = [&](const Vector3d& P, const Vector3d& direction) {
    const Vector3d u = direction.normalized();
    Joints Q = Joints::Zero();
    Q[3] = std::atan2(std::hypot(u.x(), u.y()), u.z());
    Q[4] = std::atan2(u.x(), u.y());
    Q = inverse_fixed_rotary(chain, P, Q, Vector3d::Zero()).value();
    const ToolPose back = forward(chain, Q, Vector3d::Zero());
    EXPECT_LT((back.p_WT - P).norm(), kRoundTrip);
    EXPECT_LT((back.k_W - u).norm(), kRounding);
    return Q;
  };
  const Joints Q_0 = post(P_0, {0.00639, -0.036377, 0.99927});
  const Joints Q_1 = post(P_1, {0.006393, -0.068922, 0.99960});
  EXPECT_NEAR(std::remainder(Q_1[4] - Q_0[4], 360 * deg) / deg, 4.7, 0.05);  // as printed
  double peak = 0.0;
  for (int i = 0; i <= 200; ++i) {
    const double t = i / 200.0;
    const Vector3d p = forward(chain, Q_0 + t * (Q_1 - Q_0), Vector3d::Zero()).p_WT;
    peak = std::max(peak, (p - (P_0 + t * (P_1 - P_0))).norm());
  }
  EXPECT_NEAR(peak / mm, 0.156, 0.0005);  // as printed
}

TEST(ChainLaws, ForwardOfInverseIsIdentityForEveryStructure) {
  Uniform random(7);
  for (const Structure& s : all_structures()) {
    const MachineChain chain = random_chain(s, random);
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector();
    const ToolPose P = forward(chain, Q, p_ST);
    const auto back = inverse_fixed_rotary(chain, P.p_WT, Q, p_ST);
    ASSERT_TRUE(back) << to_string(s);
    ASSERT_LT((forward(chain, *back, p_ST).p_WT - P.p_WT).norm(), kRoundTrip) << to_string(s);
  }
}

TEST(ChainLaws, JacobianMovesTheTipAsTheJointsDo) {
  Uniform random(8);
  for (const Structure& s : all_structures()) {
    const MachineChain chain = random_chain(s, random);
    const Joints Q = random_joints(chain, random);
    Joints moved = Q;
    for (const ChainAxis& a : chain.axes) {
      if (is_linear(a.axis)) moved[a.joint] += 0.3 * random();
    }
    const Vector3d step =
        forward(chain, moved, Vector3d::Zero()).p_WT - forward(chain, Q, Vector3d::Zero()).p_WT;
    const Vector3d predicted = linear_jacobian(chain, Q) * (moved - Q).head<3>();
    ASSERT_LT((step - predicted).norm(), kRounding) << to_string(s);
  }
}

TEST(ChainLaws, ToolAxisKeepsUnitLengthForEveryStructure) {
  Uniform random(9);
  for (const Structure& s : all_structures()) {
    const MachineChain chain = random_chain(s, random);
    const ToolPose P = forward(chain, random_joints(chain, random), Vector3d::Zero());
    ASSERT_NEAR(P.k_W.norm(), 1.0, kRounding) << to_string(s);
  }
}

TEST(Inverse, IsNothingWhereTheMachineCannotGo) {
  const MachineChain flat = chain_of("[w X b Y t]");
  EXPECT_TRUE(inverse_fixed_rotary(flat, {0.1, 0.2, 0.0}, Joints::Zero(), Vector3d::Zero()));
  EXPECT_TRUE(inverse_fixed_rotary(flat, {0.1, 0.2, 0.9e-9}, Joints::Zero(), Vector3d::Zero()));
  EXPECT_FALSE(inverse_fixed_rotary(flat, {0.1, 0.2, 1.1e-9}, Joints::Zero(), Vector3d::Zero()));
}

TEST(Inverse, IsNothingWhereTwoLinearAxesAreParallel) {
  const MachineChain chain = chain_of("[w X C b Y Z t]");
  const Vector3d p{0.0, 0.0, 0.1};
  Joints Q = Joints::Zero();
  Q[3] = 90 * deg;  // Y now moves along X
  EXPECT_FALSE(inverse_fixed_rotary(chain, p, Q, Vector3d::Zero()));
  Q[3] = 89 * deg;
  EXPECT_TRUE(inverse_fixed_rotary(chain, p, Q, Vector3d::Zero()));
}

// Normal equations, and x orthogonal to what J takes to 0.
TEST(LeastSquares, OfAnyRankAreTheSmallest) {
  constexpr double kTolerance = 1e-12;
  const Vector3d x = Vector3d::UnitX(), z = Vector3d::UnitZ(), zero = Vector3d::Zero();
  const Vector3d a = Vector3d(1.0, 2.0, 2.0) / 3.0, b = Vector3d(0.8, 0.0, 0.6);
  const Vector3d v(0.3, -0.2, 0.7);
  const auto columns = [](const Vector3d& one, const Vector3d& two, const Vector3d& three) {
    return (Eigen::Matrix3d() << one, two, three).finished();
  };
  struct Case {
    Eigen::Matrix3d J;
    int rank;
    Vector3d null;  // J null = 0
  };
  for (const Case& one :
       {Case{columns(zero, zero, zero), 0, zero}, Case{columns(a, zero, zero), 1, z},
        Case{columns(a, a, zero), 1, {1.0, -1.0, 0.0}},
        Case{columns(a, zero, b), 2, Vector3d::UnitY()},
        Case{columns(a, b, a), 2, {1.0, 0.0, -1.0}}, Case{columns(a, b, x), 3, zero}}) {
    const LeastSquares found = least_squares(one.J, v);
    EXPECT_EQ(found.rank, one.rank) << one.J;
    EXPECT_LT((one.J.transpose() * (one.J * found.x - v)).norm(), kTolerance) << one.J;
    EXPECT_LT(std::abs(one.null.dot(found.x)), kTolerance) << one.J;
  }
}

TEST(LeastSquares, TakeAxesAsParallelWithinTheLimit) {
  const auto at = [](double angle) {
    Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
    J.col(1) = Vector3d(std::cos(angle), std::sin(angle), 0.0);
    return least_squares(J, {0.1, 0.0, 0.1}).rank;
  };
  EXPECT_EQ(at(1.1 * kParallel), 3);
  EXPECT_EQ(at(0.9 * kParallel), 2);
}

}  // namespace
}  // namespace servomill::plant::chain_test
