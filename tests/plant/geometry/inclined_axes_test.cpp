/// Machines with rotary axes that point anywhere: the laws of VolumetricModel, and 4x4 matrices.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "plant/geometry/rotation_vector.h"
#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/units.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::inclined_axes_test {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 4e-15;  // m or 1: about a hundred operations on numbers below 2

// Every fifth structure with a rotary axis.
std::vector<Structure> some_structures() {
  std::vector<Structure> some;
  std::size_t n = 0;
  for (const Structure& s : all_structures()) {
    const auto is_rotary = [](const StructureAxis& a) { return !is_linear(a.axis); };
    if (std::any_of(s.axes.begin(), s.axes.end(), is_rotary) && n++ % 5 == 0) some.push_back(s);
  }
  return some;
}

// The tool pose by the product of error_model.h, with the turns of axes about their directions.
ToolPose by_matrices(const MachineChain& chain, const ErrorModel& errors, const Joints& Q,
                     const Vector3d& p_ST) {
  using Eigen::Isometry3d;
  Isometry3d H = Isometry3d::Identity();
  for (const ChainAxis& a : chain.axes) {
    Vector3d shift, turn, shift_0, turn_0;
    for (int i = 0; i < 3; ++i) {
      const Axis along = kAllAxes[static_cast<std::size_t>(i)];
      const Axis about = kAllAxes[static_cast<std::size_t>(i) + 3];
      shift[i] = errors.component({along, a.axis, false}).value(Q[a.joint]);
      turn[i] = errors.component({about, a.axis, false}).value(Q[a.joint]);
      shift_0[i] = errors.location({along, a.axis, true});
      turn_0[i] = errors.location({about, a.axis, true});
    }
    const auto at_centre = [&](const Isometry3d& motion) {
      return Eigen::Translation3d(a.centre) * motion * Eigen::Translation3d(-a.centre);
    };
    const auto motion_of = [&](const Vector3d& angles) {
      Isometry3d motion = Isometry3d::Identity();
      motion.linear() = TurnOf(a.R_MA * angles).matrix();
      return motion;
    };
    const Isometry3d E = Eigen::Translation3d(a.R_MA * shift) * motion_of(turn);
    const Isometry3d L = motion_of(turn_0) * Eigen::Translation3d(a.R_MA * shift_0);
    Isometry3d J = Isometry3d::Identity();
    if (is_linear(a.axis)) {
      J.translate(Q[a.joint] * direction_of(a));
    } else {
      const double q = (a.sense == Sense::table ? -1.0 : 1.0) * Q[a.joint];
      J.rotate(Eigen::AngleAxisd(q, direction_of(a)));
    }
    const Isometry3d moved = L * J * L.inverse();
    H = H * at_centre(a.side == Side::tool ? moved * E : E * moved);
  }
  return {H * p_ST, H.linear() * Vector3d::UnitZ()};
}

TEST(Incline, TurnsTheFrameOfTheAxisTheShortestWay) {
  ChainAxis B{.axis = Axis::B};
  incline(B, {0.0, 3.0, 3.0});
  EXPECT_TRUE(B.is_inclined);
  EXPECT_LT((direction_of(B) - Vector3d(0.0, std::sqrt(0.5), std::sqrt(0.5))).norm(), kRounding);
  const Eigen::AngleAxisd shortest(45 * deg, Vector3d::UnitX());
  EXPECT_LT((B.R_MA - shortest.toRotationMatrix()).norm(), kRounding);
}

TEST(Incline, LeavesAnAxisUprightThatPointsWhereItsLetterSays) {
  ChainAxis B{.axis = Axis::B};
  incline(B, {0.0, 7.0, 0.0});
  EXPECT_FALSE(B.is_inclined);
  EXPECT_EQ(B.R_MA, Eigen::Matrix3d::Identity());
}

TEST(Incline, TheOppositeDirectionIsHalfATurnAboutTheNextAxis) {
  ChainAxis B{.axis = Axis::B};
  incline(B, {0.0, -2.0, 0.0});
  const Eigen::Matrix3d half_turn = Vector3d(-1.0, -1.0, 1.0).asDiagonal();
  EXPECT_LT((B.R_MA - half_turn).norm(), kRounding);
  // and nearly so is as exact
  incline(B, {0.0, -1.0, 1e-7});
  EXPECT_LT((B.R_MA * B.R_MA.transpose() - Eigen::Matrix3d::Identity()).norm(), kRounding);
  EXPECT_LT((direction_of(B) - Vector3d(0.0, -1.0, 1e-7)).norm(), 1e-14);  // 1e-7 squared
}

TEST(NutatingHead, TurnsTheToolFromUprightToLevel) {
  MachineChain chain = make_chain(parse_structure("[w b X Y Z C B t]"));
  incline(chain.at(Axis::B), {0.0, 1.0, 1.0});
  Joints Q = Joints::Zero();
  Q[3] = 180 * deg;
  EXPECT_LT((forward(chain, Q, Vector3d::Zero()).k_W - Vector3d::UnitY()).norm(), kRounding);
}

TEST(InclinedAxes, ForwardIsTheProductOfMatrices) {
  Uniform random(81);
  for (const Structure& s : some_structures()) {
    const MachineChain chain = random_inclined_chain(s, random);
    const ErrorModel errors = random_errors(random, 1e-2);
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector();
    const ToolPose expected = by_matrices(chain, errors, Q, p_ST);
    const ToolPose P = VolumetricModel(chain, errors).forward(Q, p_ST);
    ASSERT_LT((P.p_WT - expected.p_WT).norm(), kRounding) << to_string(s);
    ASSERT_LT((P.k_W - expected.k_W).norm(), kRounding) << to_string(s);
  }
}

TEST(InclinedAxes, ZeroErrorsGiveTheIdealMachineBitForBit) {
  Uniform random(82);
  for (const Structure& s : some_structures()) {
    const MachineChain chain = random_inclined_chain(s, random);
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector();
    const VolumetricModel model(chain, {});
    const ToolPose P = forward(chain, Q, p_ST), P_true = model.forward(Q, p_ST);
    ASSERT_EQ(P_true.p_WT, P.p_WT) << to_string(s);
    ASSERT_EQ(P_true.k_W, P.k_W) << to_string(s);
    ASSERT_EQ(model.error(Q, p_ST).dp_W, Vector3d::Zero());
    ASSERT_EQ(model.first_order_error(Q, p_ST).dp_W, Vector3d::Zero());
    ASSERT_EQ(model.joint_offset(Q, p_ST), Vector3d::Zero());
  }
}

TEST(InclinedAxes, ExactMinusFirstOrderShrinksWithTheSquareOfTheErrors) {
  Uniform random(83);
  const double size = 1e-3;  // m, rad
  for (const Structure& s : some_structures()) {
    const MachineChain chain = random_inclined_chain(s, random);
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
    // A dozen errors of up to 3 size per axis on each of five axes: third order.
    ASSERT_LT((4.0 * rest(0.5) - rest(1.0)).norm(), std::pow(30.0 * size, 3)) << to_string(s);
  }
}

TEST(InclinedAxes, JacobianIsTheLimitOfCentralDifferences) {
  Uniform random(84);
  const double h = 1e-4;           // m, rad
  const double truncation = 2e-8;  // h^2/6 times a third derivative of about 1 (turns) + errors
  for (const Structure& s : some_structures()) {
    const MachineChain chain = random_inclined_chain(s, random);
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

TEST(InclinedAxes, IdealJacobianIsThatOfAMachineWithoutErrors) {
  Uniform random(85);
  for (const Structure& s : some_structures()) {
    const MachineChain chain = random_inclined_chain(s, random);
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector();
    const PoseJacobian ideal = jacobian(chain, Q, p_ST);
    const PoseJacobian J = VolumetricModel(chain, {}).jacobian(Q, p_ST);
    ASSERT_LT((J.J_pQ - ideal.J_pQ).norm(), kRounding) << to_string(s);
    ASSERT_LT((J.J_kQ - ideal.J_kQ).norm(), kRounding) << to_string(s);
    ASSERT_LT((ideal.J_pQ.leftCols<3>() - linear_jacobian(chain, Q)).norm(), kRounding);
  }
}

TEST(InclinedAxes, JointOffsetMovesTheIdealTipByTheVolumetricError) {
  Uniform random(86);
  for (const Structure& s : some_structures()) {
    const MachineChain chain = random_inclined_chain(s, random);
    if (number_of_linear_axes(chain) < 3) continue;
    ErrorModel errors = random_errors(random, 1e-4);
    for (const bool rotary_axes_are_ideal : {false, true}) {
      if (rotary_axes_are_ideal) {  // the linear-axis path, where there is no rotary axis in
                                    // between
        for (const Axis a : {Axis::A, Axis::B, Axis::C}) {
          const auto i = static_cast<std::size_t>(index_of(a));
          errors.components[i] = {};
          errors.locations[i].setZero();
        }
      }
      const VolumetricModel model(chain, errors);
      const Joints Q = random_joints(chain, random);
      const Vector3d p_ST = 0.2 * random.vector();
      Joints moved = Q;
      moved.head<3>() += model.joint_offset(Q, p_ST);
      const Vector3d step = forward(chain, moved, p_ST).p_WT - forward(chain, Q, p_ST).p_WT;
      ASSERT_LT((step - model.error(Q, p_ST).dp_W).norm(), kRounding) << to_string(s);
    }
  }
}

TEST(InclinedAxes, ManyPosesAreThoseOfEachBitForBit) {
  Uniform random(87);
  for (const Structure& s : some_structures()) {
    const MachineChain chain = random_inclined_chain(s, random);
    const VolumetricModel model(chain, random_errors(random, 1e-4));
    const Vector3d p_ST = 0.2 * random.vector();
    std::vector<Joints> Q(9);
    for (Joints& q : Q) q = random_joints(chain, random);
    std::vector<ToolPose> poses(Q.size());
    std::vector<VolumetricError> errors(Q.size());
    std::vector<Vector3d> offsets(Q.size());
    model.poses(Q, p_ST, poses);
    model.errors(Q, p_ST, errors);
    model.joint_offsets(Q, p_ST, offsets);
    for (std::size_t n = 0; n < Q.size(); ++n) {
      ASSERT_EQ(poses[n].p_WT, model.forward(Q[n], p_ST).p_WT) << to_string(s);
      ASSERT_EQ(poses[n].k_W, model.forward(Q[n], p_ST).k_W) << to_string(s);
      ASSERT_EQ(errors[n].dp_W, model.error(Q[n], p_ST).dp_W) << to_string(s);
      ASSERT_EQ(offsets[n], model.joint_offset(Q[n], p_ST)) << to_string(s);
    }
  }
}

}  // namespace
}  // namespace servomill::plant::inclined_axes_test
