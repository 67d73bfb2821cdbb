/// Which errors the "43" of five-axis machines are, and where squareness of the spindle is among
/// them. There are 30 component errors and 14 names of location errors: 2 angles of each linear
/// axis, of which 3 say what is meant by X, Y and Z and 3 are squarenesses, and 4 errors of each
/// rotary one. To these 30 + 3 + 8 = 41 one count adds the 2 zero positions, the other the 2
/// squarenesses of the spindle (EA0S, EB0S: turned about X and Y against Z). Both are constants of
/// component errors: ECC = c0 is the zero position of C, EAZ = c0 and EBZ = c0 turn the spindle
/// that Z carries.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "plant/geometry/pose_inverse.h"
#include "plant/geometry/rotation_vector.h"
#include "plant/vocabulary/units.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::spindle_squareness_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kRounding = 1e-15;  // m, at 1 m
constexpr double kTilt_A = 30 * urad, kTilt_B = -20 * urad;

int number_of_names(const JointLayout& layout, bool location) {
  int count = 0;
  for (const Axis axis : kAllAxes) {
    for (const Axis direction : kAllAxes) {
      if (!why_meaningless({direction, axis, location}, layout)) ++count;
    }
  }
  return count;
}

ErrorModel tilted_spindle() {
  ErrorModel errors;
  errors.component("EAZ"_err) = constant(kTilt_A);
  errors.component("EBZ"_err) = constant(kTilt_B);
  return errors;
}

TEST(FortyThreeErrors, AreThirtyComponentsElevenLocationsAndTwoConstants) {
  const JointLayout layout = make_chain(parse_structure("[w C' B' X b Y Z (C1) t]")).layout;
  EXPECT_EQ(number_of_names(layout, false), 30);
  constexpr int kOfTheFrame = 3;
  EXPECT_EQ(number_of_names(layout, true) - kOfTheFrame, 11);
}

// The ideal machine with a tool that is turned at the spindle nose, everywhere.
TEST(SpindleSquareness, IsAConstantTurnOfTheAxisThatCarriesTheSpindle) {
  Uniform random(19);
  const Matrix3d R = TurnOf(Vector3d(kTilt_A, kTilt_B, 0.0)).matrix();
  for (const char* text : {"[w C' B' X b Y Z (C1) t]", "[w X' Y' b Z t]", "[w C' X' b Y Z t]"}) {
    const MachineChain chain = make_chain(parse_structure(text));
    const VolumetricModel model(chain, tilted_spindle());
    for (int n = 0; n < 50; ++n) {
      const Joints Q = random_joints(chain, random);
      const Vector3d p_ST(0.01, -0.02, -0.11);
      const ToolPose actual = model.forward(Q, p_ST);
      const Vector3d shift = R * p_ST;  // the turned tool, as if it were another one
      const ToolPose turned = forward(chain, Q, shift), nominal = forward(chain, Q, p_ST);
      EXPECT_LE((actual.p_WT - turned.p_WT).norm(), kRounding) << text;
      EXPECT_NEAR((actual.k_W - nominal.k_W).norm(), std::hypot(kTilt_A, kTilt_B), 1e-14) << text;
      // of first order: the lever of the tool, turned like it
      const VolumetricError first = model.first_order_error(Q, p_ST);
      const Vector3d w(kTilt_A, kTilt_B, 0.0);
      EXPECT_NEAR(first.dp_W.norm(), w.cross(p_ST).norm(), kRounding) << text;
      EXPECT_NEAR(first.dk_W.norm(), w.cross(Vector3d::UnitZ()).norm(), kRounding) << text;
    }
  }
}

TEST(SpindleSquareness, IsTakenByTheNonidealInverse) {
  Uniform random(23);
  const MachineChain chain = make_chain(parse_structure("[w C' B' X b Y Z (C1) t]"));
  const VolumetricModel model(chain, tilted_spindle());
  const InverseKinematics ideal(chain);
  const Vector3d p_ST(0.0, 0.0, -0.11);
  for (int n = 0; n < 50; ++n) {
    Joints Q = random_joints(chain, random);
    Q[3] = 0.6 + 0.3 * random();  // away from the singular direction
    const ToolPose wanted = forward(chain, Q, p_ST);
    const TrueJoints found = nonideal_inverse(model, ideal, wanted, p_ST, Q);
    ASSERT_TRUE(found.is_reached());
    const ToolPose got = model.forward(found.Q, p_ST);
    EXPECT_LE((got.p_WT - wanted.p_WT).norm(), kPoseTolerance);
    EXPECT_LE((got.k_W - wanted.k_W).norm(), kPoseTolerance);
  }
}

}  // namespace
}  // namespace servomill::plant::spindle_squareness_test
