#include "plant/geometry/pose_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "tests/plant/geometry/random_errors.h"
#include "tests/plant/kinematics/machine_kinds.h"

namespace servomill::plant::pose_inverse_test {
namespace {

using Eigen::Vector3d;

// Smooth errors of up to 1 mm and 1 mrad each, thirty-odd of them at work at once: random_function
// reaches three times its size.
constexpr double kSize = 1e-3 / 3.0;
const Vector3d kTip{0.0, 0.0, -0.15};

MachineChain chain_of(std::string_view text) { return make_chain(parse_structure(text)); }

double miss(const VolumetricModel& model, const Joints& Q, const Vector3d& p_ST,
            const ToolPose& P) {
  const ToolPose got = model.forward(Q, p_ST);
  return std::max((got.p_WT - P.p_WT).norm(), (got.k_W - P.k_W).norm());
}

// How far apart the ways lie on which the two rotary axes move the tool axis (1/rad^2).
double spread(const MachineChain& chain, const Joints& Q, const Vector3d& p_ST) {
  const PoseJacobian J = jacobian(chain, Q, p_ST);
  return J.J_kQ.col(3).cross(J.J_kQ.col(4)).norm();
}

TEST(PoseInverse, OfAMachineWithoutErrorsIsTheIdealOneWithoutAStep) {
  Uniform random(91);
  for (const Kind& kind : kKinds) {
    const MachineChain chain = random_chain_of(kind, random);
    const VolumetricModel model(chain, {});
    const InverseKinematics ideal(chain);
    const Joints Q = random_joints(chain, random);
    const ToolPose P = forward(chain, Q, kTip);
    const TrueJoints found = nonideal_inverse(model, ideal, P, kTip, Q);
    EXPECT_TRUE(found.is_reached()) << kind.name;
    EXPECT_EQ(found.steps, 0) << kind.name;
    EXPECT_LT((found.Q - ideal.nearest(P, kTip, Q).Q).norm(), 1e-12) << kind.name;  // rounding
  }
}

// Wherever the tool axis does not come near a singular direction (or the edge of what is reached)
// by a hundred times the errors.
TEST(PoseInverse, MeetsTipAndToolAxisInFourStepsForEveryKindOfMachine) {
  constexpr int kPoses = 600;
  constexpr int kMaxSteps = 4;  // promised by the issue
  constexpr double kSpread = 0.1;
  Uniform random(92);
  int most = 0, counted = 0;
  double worst = 0.0;
  for (const Kind& kind : kKinds) {
    for (int n = 0; n < kPoses; ++n) {
      const MachineChain chain = random_chain_of(kind, random);
      const VolumetricModel model(chain, random_errors(random, kSize));
      const Joints Q = random_joints(chain, random);
      const Vector3d p_ST = 0.2 * random.vector();
      const ToolPose P = model.forward(Q, p_ST);
      if (spread(chain, Q, p_ST) < kSpread) continue;
      const TrueJoints found = nonideal_inverse(model, InverseKinematics(chain), P, p_ST, Q);
      ASSERT_TRUE(found.is_reached()) << kind.name << " " << Q.transpose();
      ASSERT_LE(found.steps, kMaxSteps) << kind.name << " " << Q.transpose();
      ASSERT_FALSE(found.is_singular);
      ++counted;
      most = std::max(most, found.steps);
      worst = std::max(worst, miss(model, found.Q, p_ST, P));
    }
  }
  EXPECT_GT(counted, 9000);
  EXPECT_LE(worst, 2.0 * kPoseTolerance);
  RecordProperty("most_steps", most);
}

// Quadratic: what is left after a step is about the square of what was before.
TEST(PoseInverse, ConvergesQuadratically) {
  const MachineChain chain = chain_of("[w C' B' X b Y Z t]");
  Uniform random(93);
  const VolumetricModel model(chain, random_errors(random, kSize));
  Joints Q = Joints::Zero();
  Q << 0.1, 0.05, -0.1, 0.7, 0.4;
  const ToolPose P = model.forward(Q, kTip);
  const auto steps_from = [&](double distance) {
    const Joints start = Q + Joints::Constant(distance);
    return nonideal_inverse_from(model, P, kTip, start).steps;
  };
  EXPECT_EQ(steps_from(1e-2), 3);  // 1e-4, 1e-8, 1e-16
  EXPECT_EQ(steps_from(1e-4), 2);
  EXPECT_EQ(steps_from(1e-7), 1);
}

TEST(PoseInverse, KeepsTheTurnsAndTheSolutionOfTheJointsBefore) {
  const MachineChain chain = chain_of("[w C' B' X b Y Z t]");
  Uniform random(94);
  const VolumetricModel model(chain, random_errors(random, 1e-5));
  const InverseKinematics ideal(chain);
  for (const double B : {-40 * deg, 40 * deg}) {
    Joints Q = Joints::Zero();
    Q << 0.1, 0.05, -0.1, B, 3.5;
    Joints Q_near = Q;
    Q_near.tail<2>() += Eigen::Vector2d(0.1, -0.2);
    const TrueJoints found = nonideal_inverse(model, ideal, model.forward(Q, kTip), kTip, Q_near);
    EXPECT_TRUE(found.is_reached());
    EXPECT_LT((found.Q - Q).norm(), 1e-11);  // 1e-12 over the least slope
  }
}

TEST(PoseInverse, AtTheSingularDirectionOfTheTrueMachineKeepsTheFreeAngle) {
  // C leans by 100 urad about Y: upright for it is B = 100 urad
  const MachineChain chain = chain_of("[w C' B' X b Y Z t]");
  ErrorModel errors;
  errors.location("EB0C"_err) = 100 * urad;
  const VolumetricModel model(chain, errors);
  Joints Q = Joints::Zero();
  Q.tail<2>() << 100 * urad, 2.0;
  const ToolPose P = model.forward(Q, kTip);
  const TrueJoints found = nonideal_inverse_from(model, P, kTip, Q + Joints::Constant(1e-5));
  EXPECT_TRUE(found.is_singular);
  EXPECT_TRUE(found.is_reached()) << found.miss_k;
  EXPECT_NEAR(found.Q[3], Q[3], kPoseTolerance);
  EXPECT_NEAR(found.Q[4], 2.0 + 1e-5, 1e-7);
}

// Near there, what the machine did is found again, or the remaining path is reported.
TEST(PoseInverse, NearASingularDirectionMeetsThePoseOrSaysByWhatItMisses) {
  Uniform random(95);
  int missed = 0;
  constexpr int kPoses = 4000;
  for (int n = 0; n < kPoses; ++n) {
    const MachineChain chain = chain_of(n % 2 == 0 ? "[w C' B' X b Y Z t]" : "[w b X Y Z C A t]");
    const VolumetricModel model(chain, random_errors(random, 1e-5));
    Joints Q = random_joints(chain, random);
    Q[3] = 1e-3 * random();  // B or A
    const ToolPose P = model.forward(Q, kTip);
    const TrueJoints found = nonideal_inverse(model, InverseKinematics(chain), P, kTip, Q);
    ASSERT_LE(found.miss_p, kPoseTolerance);
    ASSERT_LT(std::abs(miss(model, found.Q, kTip, P) - std::max(found.miss_p, found.miss_k)),
              1e-13);
    ASSERT_LT(found.miss_k, 2e-4);  // what all errors together turn
    if (!found.is_reached()) ++missed;
  }
  EXPECT_LE(missed, kPoses / 100);
}

TEST(PoseInverse, OfThreePlusOneAxesMeetsTheTipAndComesAsNearToTheToolAxisAsItCan) {
  const MachineChain chain = chain_of("[w B' X b Y Z t]");
  ErrorModel errors;
  errors.component("EAX"_err) = constant(50 * urad);  // across: no axis can undo it
  errors.component("EBX"_err) = constant(30 * urad);  // B can
  const VolumetricModel model(chain, errors);
  const ToolPose P{{0.1, 0.05, 0.1}, {0.6, 0.0, 0.8}};
  const TrueJoints found =
      nonideal_inverse(model, InverseKinematics(chain), P, kTip, Joints::Zero());
  EXPECT_EQ(found.reach, Reach::orientation);
  EXPECT_FALSE(found.is_singular);
  EXPECT_LE(found.miss_p, kPoseTolerance);
  EXPECT_NEAR(found.miss_k, 50 * urad, 1e-8);  // to second order, 50 urad x 30 urad and more
  EXPECT_NEAR(found.Q[3], std::asin(0.6) - 30 * urad, 1e-8);
}

TEST(PoseInverse, OfThreeAxesIsThatOfTheTip) {
  const MachineChain chain = chain_of("[w X b Y Z t]");
  Uniform random(96);
  const VolumetricModel model(chain, random_errors(random, 1e-4));
  const ToolPose P{{0.1, 0.05, 0.1}, Vector3d::UnitZ()};
  const TrueJoints found =
      nonideal_inverse(model, InverseKinematics(chain), P, kTip, Joints::Zero());
  const auto tip = model.inverse(P.p_WT, Joints::Zero(), kTip);
  ASSERT_TRUE(tip);
  EXPECT_LT((found.Q - *tip).norm(), kPoseTolerance);
  EXPECT_EQ(found.reach, Reach::orientation);
}

TEST(PoseInverse, SaysWhereTheErrorsLeadBeyondTheTravel) {
  const MachineChain chain = chain_of("[w C' B' X b Y Z t]");
  ErrorModel errors;
  errors.component("EXX"_err) = constant(-10 * um);  // X must go that much farther
  const VolumetricModel model(chain, errors);
  for (const double room : {9.9 * um, 10.1 * um}) {
    InverseSettings settings;
    settings.upper[0] = 0.1 + room;
    const TrueJoints found =
        nonideal_inverse(model, InverseKinematics(chain, settings),
                         {{0.1, 0.0, 0.0}, Vector3d::UnitZ()}, kTip, Joints::Zero());
    EXPECT_EQ(found.reach, room < 10 * um ? Reach::travel : Reach::reached);
    EXPECT_NEAR(found.Q[0], 0.1 + 10 * um, kPoseTolerance);
  }
}

// Only the last step of Newton leads beyond the end of B: the mirrored solution, with the other
// sign of B and half a turn of C, is as good.
TEST(PoseInverse, NearTheTravelTakesTheSolutionThatLiesWithin) {
  const MachineChain chain = chain_of("[w C' B' X b Y Z t]");
  constexpr double kSlope = 1e-3, kAngle = 40 * deg;
  ErrorModel errors;
  errors.component("EBB"_err) = polynomial({0.0, -kSlope});
  const VolumetricModel model(chain, errors);
  const ToolPose P{{0.02, 0.0, 0.1}, {std::sin(kAngle), 0.0, std::cos(kAngle)}};
  const Joints Q_near = InverseKinematics(chain).nearest(P, kTip, Joints::Zero()).Q;
  ASSERT_NEAR(Q_near[3], kAngle, kPoseTolerance);
  const double B = kAngle / (1.0 - kSlope), begin = kAngle * (1.0 + kSlope);
  for (const double end : {0.5 * (begin + B), B + (B - begin)}) {
    InverseSettings settings;
    settings.lower[3] = -60 * deg;
    settings.upper[3] = end;
    const InverseKinematics ideal(chain, settings);
    const TrueJoints found = nonideal_inverse(model, ideal, P, kTip, Q_near);
    EXPECT_TRUE(found.is_reached());
    EXPECT_NEAR(found.Q[3], end < B ? -B : B, kPoseTolerance);
    EXPECT_LT(miss(model, found.Q, kTip, P), 2.0 * kPoseTolerance);
  }
}

TEST(PoseInverse, PositionOfAMachineThatLacksALinearAxisIsReported) {
  const MachineChain chain = chain_of("[w C' B' X b Y t]");
  const VolumetricModel model(chain, {});
  const TrueJoints found =
      nonideal_inverse(model, InverseKinematics(chain), {{0.1, 0.2, -0.05}, Vector3d::UnitZ()},
                       kTip, Joints::Zero());
  EXPECT_EQ(found.reach, Reach::position);
  EXPECT_NEAR(found.miss_p, 0.1, kPoseTolerance);
}

}  // namespace
}  // namespace servomill::plant::pose_inverse_test
