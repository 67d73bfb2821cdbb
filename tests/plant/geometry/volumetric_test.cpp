#include "plant/geometry/volumetric.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

#include "plant/geometry/volumetric_kernel.h"
#include "plant/vocabulary/units.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::volumetric_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kRounding = 2e-15;   // m or 1: some tens of operations on numbers below 2
constexpr double kRoundTrip = 1e-12;  // m, promised by the issue

MachineChain chain_of(std::string_view text) { return make_chain(parse_structure(text)); }

ErrorModel with(const ErrorName& name, double value) {
  ErrorModel errors;
  if (name.is_location) {
    errors.location(name) = value;
  } else {
    errors.component(name) = constant(value);
  }
  return errors;
}

// --- closed forms ------------------------------------------------------------------------------

TEST(Squareness, TurnsTheDirectionOfItsAxis) {
  const double angle = 50 * urad;
  const Joints Q{0.1, 0.2, 0.3, 0.0, 0.0};
  const Vector3d tip = Vector3d::Zero();
  for (const char* text : {"[w b X Y Z t]", "[w X b Y Z t]", "[w Z' Y' b X t]", "[w X Y Z b t]"}) {
    const MachineChain chain = chain_of(text);
    const auto error = [&](ErrorName name) {
      return volumetric_error(chain, with(name, angle), Q, tip).dp_W;
    };
    const double s = std::sin(angle), v = std::cos(angle) - 1.0;
    EXPECT_LT((error("EC0Y"_err) - Vector3d(-s * 0.2, v * 0.2, 0.0)).norm(), kRounding) << text;
    EXPECT_LT((error("EB0Z"_err) - Vector3d(s * 0.3, 0.0, v * 0.3)).norm(), kRounding) << text;
    EXPECT_LT((error("EA0Z"_err) - Vector3d(0.0, -s * 0.3, v * 0.3)).norm(), kRounding) << text;
    EXPECT_LT((error("EC0X"_err) - Vector3d(v * 0.1, s * 0.1, 0.0)).norm(), kRounding) << text;
  }
}

TEST(Squareness, DoesNotTiltTheTool) {
  const VolumetricError e = volumetric_error(chain_of("[w X b Y Z t]"), with("EA0Z"_err, 1e-3),
                                             {0.1, 0.2, 0.3, 0, 0}, {0, 0, -0.1});
  EXPECT_LT(e.dk_W.norm(), kRounding);
}

TEST(LeverArm, OfAToolSideAxisReachesFromTheSlideToTheTip) {
  const Vector3d tool{0.0, 0.0, -0.15};
  const Joints Q{0.1, 0.2, 0.3, 0.0, 0.0};
  // X is followed by Y, Z and the tool; Z by the tool alone
  const MachineChain chain = chain_of("[w b X Y Z t]");
  const Vector3d turn_x{20 * urad, 0.0, 0.0};
  const Vector3d arm_X = Vector3d(0.0, 0.2, 0.3) + tool;
  const ErrorModel roll_X = with("EAX"_err, 20 * urad), pitch_Z = with("EAZ"_err, 20 * urad);
  EXPECT_LT(
      (first_order_volumetric_error(chain, roll_X, Q, tool).dp_W - turn_x.cross(arm_X)).norm(),
      kRounding);
  EXPECT_LT(
      (first_order_volumetric_error(chain, pitch_Z, Q, tool).dp_W - turn_x.cross(tool)).norm(),
      kRounding);
  EXPECT_LT(
      (first_order_volumetric_error(chain, roll_X, Q, tool).dk_W - turn_x.cross(Vector3d::UnitZ()))
          .norm(),
      kRounding);
  // 20 urad x 0.3 m = 6 um
  const Joints Q_300{0.0, 0.3, 0.0, 0.0, 0.0};
  EXPECT_NEAR(first_order_volumetric_error(chain, roll_X, Q_300, Vector3d::Zero()).dp_W.z(), 6 * um,
              kRounding);
}

TEST(LeverArm, OfAWorkpieceSideAxisReachesFromTheTableToTheTip) {
  // The table of [w X b Y Z t] turns about W; the tip lies at (x, y, z) + tool in W.
  const Vector3d tool{0.0, 0.0, -0.15}, turn{0.0, 0.0, 20 * urad};
  const Joints Q{0.1, 0.2, 0.3, 0.0, 0.0};
  const Vector3d arm = Vector3d(0.1, 0.2, 0.3) + tool;
  const VolumetricError e =
      first_order_volumetric_error(chain_of("[w X b Y Z t]"), with("ECX"_err, 20 * urad), Q, tool);
  EXPECT_LT((e.dp_W - turn.cross(arm)).norm(), kRounding);
}

TEST(LeverArm, StartsAtTheCentreOfTheAxis) {
  MachineChain chain = chain_of("[w b X Y Z t]");
  chain.at(Axis::X).centre = {0.0, 0.0, -0.4};
  const Vector3d turn{0.0, 1e-4, 0.0}, tool{0.0, 0.0, -0.15};
  const VolumetricError e =
      first_order_volumetric_error(chain, with("EBX"_err, 1e-4), Joints::Zero(), tool);
  EXPECT_LT((e.dp_W - turn.cross(Vector3d(0.0, 0.0, 0.25))).norm(), kRounding);
}

TEST(Straightness, MovesTheToolOfEitherSideAlike) {
  ErrorModel errors;
  errors.component("EYX"_err) = harmonic(150 * um, 62 * mm);
  const Joints Q{15.5 * mm, 0.2, 0.3, 0.0, 0.0};
  for (const char* text : {"[w X b Y Z t]", "[w b X Y Z t]"}) {
    const Vector3d d = volumetric_error(chain_of(text), errors, Q, {0, 0, -0.1}).dp_W;
    EXPECT_LT((d - Vector3d(0.0, 150 * um, 0.0)).norm(), kRounding);
  }
}

TEST(Straightness, OfAllKindsOfTermsIsTheValueOfItsFunctions) {
  ErrorModel errors;
  errors.component("EXX"_err) = polynomial({1e-5, 2e-5}) + harmonic(30 * um, 62 * mm, 0.2);
  errors.component("EYX"_err) = harmonic(150 * um, 62 * mm) + harmonic(20 * um, 10 * mm, 0.2);
  errors.component("EZX"_err) =
      harmonic(-70 * um, 10 * mm, 0.2) + linear_table({-0.1, 0.0, 0.1}, {1e-5, -2e-5, 4e-5});
  const VolumetricModel model(chain_of("[w X b Y Z t]"), errors);
  for (int i = -30; i <= 30; ++i) {
    const double x = 3.7 * mm * i;
    const Vector3d d = model.joint_offset({x, 0.1, 0.2, 0.0, 0.0}, Vector3d::Zero());
    const Vector3d e{errors.component("EXX"_err).value(x), errors.component("EYX"_err).value(x),
                     errors.component("EZX"_err).value(x)};
    EXPECT_LT((d - e).norm(), kRounding);
  }
}

TEST(RotationOfAnError, IsTheExponentialOfItsVector) {
  // A quarter turn about (1, 1, 0) carries z to (1, -1, 0)/sqrt(2); EAX = EBX.
  const double e = std::numbers::pi / 2.0 / std::numbers::sqrt2;
  const ErrorModel errors = with("EAX"_err, e) + with("EBX"_err, e);
  const ToolPose P = forward(chain_of("[w b X t]"), errors, Joints::Zero(), Vector3d::Zero());
  EXPECT_LT((P.k_W - Vector3d(1.0, -1.0, 0.0) / std::numbers::sqrt2).norm(), kRounding);
}

TEST(RotationOfAnError, IsTheSameFromSeriesAndFromSines) {
  const MachineChain chain = chain_of("[w b X t]");
  for (const double angle : {kSmallTurn * (1.0 - 1e-15), kSmallTurn * (1.0 + 1e-15),
                             kSeriesTurn * (1.0 - 1e-15), kSeriesTurn * (1.0 + 1e-15)}) {
    const ToolPose P = forward(chain, with("EAX"_err, angle), Joints::Zero(), Vector3d::Zero());
    EXPECT_LT((P.k_W - Vector3d(0.0, -std::sin(angle), std::cos(angle))).norm(), 3e-16);  // ulp
  }
}

// R-test: ball at p on C, linear axes following.
TEST(RTest, BallMovesByTheFormulaOfIso10791) {
  const double size = 1e-6;  // m, rad
  const Vector3d e{3.0 * size, -2.0 * size, 0.0}, turn{1.5 * size, 2.5 * size, 0.0};
  ErrorModel errors = with("EX0C"_err, e.x()) + with("EY0C"_err, e.y()) +
                      with("EA0C"_err, turn.x()) + with("EB0C"_err, turn.y());
  const Vector3d p{0.12, 0.03, 0.2};
  // L and L^-1 turn by |turn| each, what the other and its shift have moved
  const double second_order = 4.0 * turn.norm() * (e.norm() + turn.norm() * p.norm());
  for (const char* text : {"[w b C t]", "[w C' b t]"}) {
    const VolumetricModel model(chain_of(text), errors);
    for (int degrees = 0; degrees < 360; degrees += 15) {
      Joints Q = Joints::Zero();
      Q[3] = degrees * deg;
      const Matrix3d R = linear_jacobian(chain_of("[w C' b X Y Z t]"), Q);
      const Matrix3d D = Matrix3d::Identity() - R;
      const Vector3d d = D * e + (D * turn).cross(R * p);
      EXPECT_LT((model.first_order_error(Q, p).dp_W - d).norm(), 1e-20);  // rounding of 1e-5 m
      EXPECT_LT((model.error(Q, p).dp_W - d).norm(), second_order);
    }
  }
}

TEST(RTest, CentreOfTheTableIsWhereItsOffsetIsMeasured) {
  MachineChain chain = chain_of("[w C' b X Y Z t]");
  chain.at(Axis::C).centre = {0.3, 0.1, 0.0};
  // Half a turn about a centre displaced by (8, 0) um displaces everything by (16, 0) um.
  Joints Q{0.25, 0.2, 0.1, 180 * deg, 0.0};
  const Vector3d d = volumetric_error(chain, with("EX0C"_err, 8 * um), Q, Vector3d::Zero()).dp_W;
  EXPECT_LT((d - Vector3d(16 * um, 0.0, 0.0)).norm(), kRounding);
  // A tilt of the axis acts on the height above that centre: half a turn doubles 25 urad.
  const Joints Q_above{0.3, 0.1, 0.2, 180 * deg, 0.0};
  const VolumetricError e =
      first_order_volumetric_error(chain, with("EB0C"_err, 25 * urad), Q_above, Vector3d::Zero());
  EXPECT_LT((e.dp_W - Vector3d(2.0 * 25 * urad * 0.2, 0.0, 0.0)).norm(), kRounding);
}

TEST(AngularPositioning, TurnsTheToolWithTheAxisWhateverTheSenseOfItsCoordinate) {
  MachineChain chain = chain_of("[w C' b X Y Z t]");
  const Joints Q{0.2, 0.0, 0.0, 0.0, 0.0};
  for (const Sense sense : {Sense::tool, Sense::table}) {
    chain.at(Axis::C).sense = sense;
    const Vector3d d = volumetric_error(chain, with("ECC"_err, 1e-4), Q, Vector3d::Zero()).dp_W;
    EXPECT_LT((d - 0.2 * Vector3d(std::cos(1e-4) - 1.0, std::sin(1e-4), 0.0)).norm(), kRounding);
  }
}

// --- laws over all structures -------------------------------------------------------------------

TEST(VolumetricLaws, ZeroErrorsGiveTheIdealMachineBitForBit) {
  Uniform random(31);
  const ErrorModel zero = scaled(random_errors(random, 1.0), 0.0);
  for (const Structure& s : all_structures()) {
    const MachineChain chain = random_chain(s, random);
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector();
    const VolumetricModel model(chain, zero);
    const ToolPose P = forward(chain, Q, p_ST), P_true = model.forward(Q, p_ST);
    ASSERT_EQ(P_true.p_WT, P.p_WT) << to_string(s);
    ASSERT_EQ(P_true.k_W, P.k_W) << to_string(s);
    ASSERT_EQ(model.error(Q, p_ST).dp_W, Vector3d::Zero());
    ASSERT_EQ(model.first_order_error(Q, p_ST).dp_W, Vector3d::Zero());
    ASSERT_EQ(model.joint_offset(Q, p_ST), Vector3d::Zero());
  }
}

TEST(VolumetricLaws, ErrorIsTrueMinusIdealPose) {
  Uniform random(32);
  for (const Structure& s : all_structures()) {
    const MachineChain chain = random_chain(s, random);
    const ErrorModel errors = random_errors(random, 1e-3);
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector();
    const ToolPose P = forward(chain, Q, p_ST), P_true = forward(chain, errors, Q, p_ST);
    const VolumetricError e = volumetric_error(chain, errors, Q, p_ST);
    ASSERT_EQ(e.dp_W, P_true.p_WT - P.p_WT) << to_string(s);
    ASSERT_EQ(e.dk_W, P_true.k_W - P.k_W) << to_string(s);
    ASSERT_NEAR(P_true.k_W.norm(), 1.0, kRounding) << to_string(s);
  }
}

// Second order falls to a quarter when the errors are halved; what 4 r(1/2) - r(1) leaves is third.
TEST(VolumetricLaws, ExactMinusFirstOrderShrinksWithTheSquareOfTheErrors) {
  Uniform random(33);
  const double size = 1e-3;  // m, rad of each error
  double sum_1 = 0.0, sum_2 = 0.0, sum_4 = 0.0;
  for (const Structure& s : all_structures()) {
    const MachineChain chain = random_chain(s, random);
    const ErrorModel errors = random_errors(random, size);
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector();
    const auto rest = [&](double factor) {
      const VolumetricModel model(chain, scaled(errors, factor));
      const VolumetricError exact = model.error(Q, p_ST), first = model.first_order_error(Q, p_ST);
      Eigen::Matrix<double, 6, 1> r;
      r << exact.dp_W - first.dp_W, exact.dk_W - first.dk_W;
      return r;
    };
    const auto r_1 = rest(1.0), r_2 = rest(0.5), r_4 = rest(0.25);
    sum_1 += r_1.norm();
    sum_2 += r_2.norm();
    sum_4 += r_4.norm();
    // A dozen errors of up to 3 size per axis on each of five axes: third order.
    ASSERT_LT((4.0 * r_2 - r_1).norm(), std::pow(30.0 * size, 3)) << to_string(s);
  }
  EXPECT_NEAR(sum_1 / sum_2, 4.0, 4.0 * 30.0 * size);
  EXPECT_NEAR(sum_2 / sum_4, 4.0, 4.0 * 15.0 * size);
}

TEST(VolumetricLaws, JacobianIsTheLimitOfCentralDifferences) {
  Uniform random(34);
  const double h = 1e-4;           // m, rad
  const double truncation = 2e-8;  // h^2/6 times a third derivative of about 1 (turns) + errors
  for (const Structure& s : all_structures()) {
    const MachineChain chain = random_chain(s, random);
    const VolumetricModel model(chain, random_errors(random, 1e-2));
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector();
    const PoseJacobian J = model.jacobian(Q, p_ST);
    for (const ChainAxis& a : chain.axes) {
      Joints up = Q, down = Q;
      up[a.joint] += h;
      down[a.joint] -= h;
      const ToolPose P_up = model.forward(up, p_ST), P_down = model.forward(down, p_ST);
      const Vector3d dp = (P_up.p_WT - P_down.p_WT) / (2.0 * h);
      const Vector3d dk = (P_up.k_W - P_down.k_W) / (2.0 * h);
      ASSERT_LT((J.J_pQ.col(a.joint) - dp).norm(), truncation) << to_string(s) << letter(a.axis);
      ASSERT_LT((J.J_kQ.col(a.joint) - dk).norm(), truncation) << to_string(s) << letter(a.axis);
    }
  }
}

TEST(VolumetricLaws, JacobianOfTheIdealMachineIsTheIdealOne) {
  Uniform random(35);
  for (const Structure& s : all_structures()) {
    const MachineChain chain = random_chain(s, random);
    const Joints Q = random_joints(chain, random);
    const PoseJacobian J = VolumetricModel(chain, {}).jacobian(Q, Vector3d::Zero());
    ASSERT_LT((J.J_pQ.leftCols<3>() - linear_jacobian(chain, Q)).norm(), kRounding) << to_string(s);
  }
}

TEST(VolumetricLaws, ForwardOfNonidealInverseIsIdentity) {
  Uniform random(36);
  double worst = 0.0;
  for (const Structure& s : all_structures()) {
    const MachineChain chain = random_chain(s, random);
    const VolumetricModel model(chain, random_errors(random, 1e-4));
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector(), p_WT = model.forward(Q, p_ST).p_WT;
    // A machine without all three linear axes reaches the point only from the right rotary angles.
    const auto start = inverse_fixed_rotary(chain, forward(chain, Q, p_ST).p_WT, Q, p_ST);
    ASSERT_TRUE(start) << to_string(s);
    Joints Q_near = *start;
    for (const ChainAxis& a : chain.axes) {
      if (is_linear(a.axis)) Q_near[a.joint] += 0.01 * random();
    }
    const auto back = model.inverse(p_WT, Q_near, p_ST);
    ASSERT_TRUE(back) << to_string(s);
    worst = std::max(worst, (model.forward(*back, p_ST).p_WT - p_WT).norm());
  }
  EXPECT_LE(worst, kRoundTrip);
}

TEST(VolumetricLaws, JointOffsetMovesTheIdealTipByTheVolumetricError) {
  Uniform random(37);
  for (const Structure& s : all_structures()) {
    const MachineChain chain = random_chain(s, random);
    if (number_of_linear_axes(chain) < 3) continue;
    const VolumetricModel model(chain, random_errors(random, 1e-4));
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector();
    Joints moved = Q;
    moved.head<3>() += model.joint_offset(Q, p_ST);
    const Vector3d step = forward(chain, moved, p_ST).p_WT - forward(chain, Q, p_ST).p_WT;
    ASSERT_LT((step - model.error(Q, p_ST).dp_W).norm(), kRounding) << to_string(s);
  }
}

// --- limits -------------------------------------------------------------------------------------

TEST(JointOffset, OfAMachineWithoutZLeavesOutTheErrorInZ) {
  ErrorModel errors = with("EYX"_err, 10 * um) + with("EZX"_err, 20 * um);
  const Vector3d d =
      joint_offset(chain_of("[w X b Y t]"), errors, Joints::Zero(), Vector3d::Zero());
  EXPECT_LT((d - Vector3d(0.0, 10 * um, 0.0)).norm(), 1e-20);  // rounding of 1e-5 m
}

TEST(JointOffset, OfAMachineWithTableRotationIsTurnedIntoItsAxes) {
  // C turned by 90 degrees: an error along Y of the workpiece is one along X of the machine
  const MachineChain chain = chain_of("[w C' B' X b Y Z t]");
  Joints Q = Joints::Zero();
  Q[4] = 90 * deg;
  const Vector3d d = joint_offset(chain, with("EXX"_err, 10 * um), Q, Vector3d::Zero());
  EXPECT_LT((d - Vector3d(10 * um, 0.0, 0.0)).norm(), kRounding);
  const Vector3d dp = volumetric_error(chain, with("EXX"_err, 10 * um), Q, Vector3d::Zero()).dp_W;
  EXPECT_LT((dp - Vector3d(0.0, 10 * um, 0.0)).norm(), kRounding);
}

TEST(NonidealInverse, IsNothingWhereTwoLinearAxesAreParallel) {
  const MachineChain chain = chain_of("[w X C b Y Z t]");
  const ErrorModel errors = with("EYX"_err, 10 * um);
  Joints Q = Joints::Zero();
  Q[3] = 90 * deg;
  EXPECT_FALSE(nonideal_inverse(chain, errors, {0.0, 0.0, 0.1}, Q, Vector3d::Zero()));
  Q[3] = 89 * deg;
  EXPECT_TRUE(nonideal_inverse(chain, errors, {0.0, 0.0, 0.1}, Q, Vector3d::Zero()));
}

TEST(NonidealInverse, IsNothingForAPointOffAPlaneMachine) {
  const MachineChain chain = chain_of("[w X b Y t]");
  const ErrorModel errors = with("EZX"_err, 10 * um);
  EXPECT_TRUE(nonideal_inverse(chain, errors, {0.1, 0.2, 10 * um}, Joints::Zero(), {0, 0, 0}));
  EXPECT_FALSE(nonideal_inverse(chain, errors, {0.1, 0.2, 0.0}, Joints::Zero(), {0, 0, 0}));
}

TEST(NonidealInverse, ConvergesQuadratically) {
  // A slope of 1.5 % repeated 1.5 % of the miss in a fixed-point iteration; Newton squares it.
  ErrorModel errors;
  errors.component("EXX"_err) = harmonic(150 * um, 62 * mm);
  errors.component("EYX"_err) = harmonic(150 * um, 62 * mm);
  const VolumetricModel model(chain_of("[w X b Y Z t]"), errors);
  const Vector3d p{0.02, 0.01, 0.0};
  Joints Q = Joints::Zero();
  Q.head<3>() = p;
  double miss[3];
  for (double& m : miss) {
    const Vector3d r = p - model.forward(Q, Vector3d::Zero()).p_WT;
    m = r.norm();
    Q.head<3>() += least_squares(model.jacobian(Q, Vector3d::Zero()).J_pQ.leftCols<3>(), r).x;
  }
  // |f''| = 150 um (2 pi / 62 mm)^2 = 1.54 1/m
  EXPECT_LT(miss[1], 1.6 * miss[0] * miss[0]);
  EXPECT_LT(miss[2], 1.6 * miss[1] * miss[1] + 1e-17);
  EXPECT_GT(miss[0], 10 * um);
}

}  // namespace
}  // namespace servomill::plant::volumetric_test
