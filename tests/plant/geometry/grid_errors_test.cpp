/// Errors over several axes in the volumetric model: closed forms, sums of errors of one axis,
/// derivatives and the inverse.
#include <gtest/gtest.h>

#include <cmath>

#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/units.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::grid_errors_test {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 2e-15;  // m or 1: some tens of operations on numbers below 2

// A portal sags with the position of the slide and of the ram: EZX(x, z).
GridPoints sag() {
  GridPoints points{{Axis::X, Axis::Z}, {{-0.4, 0.0, 0.4}, {-0.4, 0.4}}, {}, {}};
  points.error = {0.0, 0.0, -8 * um, -2 * um, 0.0, 0.0};
  return points;
}

TEST(GridError, OfStraightnessMovesTheTipByItsValue) {
  const MachineChain chain = make_chain(parse_structure("[w Y' b X Z t]"));
  ErrorModel errors;
  errors.component("EZX"_err) = grid(sag());
  const VolumetricModel machine(chain, errors);
  Joints Q = Joints::Zero();
  Q[0] = 0.2;
  Q[1] = 0.3;
  Q[2] = 0.2;  // half way in x, three quarters in z
  EXPECT_NEAR(machine.error(Q, Vector3d::Zero()).dp_W.z(), 0.5 * (-8 + 0.75 * 6) * um,
              1e-16);  // after coordinates of 0.3 m
  Q[1] = -0.3;
  EXPECT_NEAR(machine.error(Q, Vector3d::Zero()).dp_W.z(), -1.75 * um, 1e-16);
}

// An angle over z alone, the error of X: the lever is that of X, the angle changes with the ram.
TEST(GridError, OfAnAngleActsWithTheLeverOfItsOwnAxis) {
  const MachineChain chain = make_chain(parse_structure("[w b X Y Z t]"));
  ErrorModel errors;
  errors.component("EBX"_err) = grid({{Axis::Z}, {{-1.0, 0.0}}, {20 * urad, 0.0}, {}});
  const VolumetricModel machine(chain, errors);
  Joints Q = Joints::Zero();
  Q[2] = -0.5;
  const Vector3d dp = machine.first_order_error(Q, Vector3d(0, 0, -0.1)).dp_W;
  EXPECT_NEAR(dp.x(), 10 * urad * -0.6, 1e-18);  // EB z
  EXPECT_NEAR(dp.z(), 0.0, 1e-18);
}

Axis other(const MachineChain& chain, Axis axis) {
  for (const ChainAxis& a : chain.axes) {
    if (a.axis != axis) return a.axis;
  }
  return axis;
}

template <class F>
void for_machines(unsigned seed, F f) {
  Uniform random(seed);
  for (const Structure& s : all_structures()) {
    if (s.axes.size() < 3 || random() < 0.7) continue;
    SCOPED_TRACE(to_string(s));
    f(random_chain(s, random), random);
  }
}

// A grid that is a function of its own axis is the table of that axis.
TEST(GridErrorLaws, SeparableGridIsTheSumOfErrorsOfOneAxis) {
  for_machines(61, [](const MachineChain& chain, Uniform& random) {
    ErrorModel tables, grids;
    for (const ChainAxis& a : chain.axes) {
      for (const Axis direction : kAllAxes) {
        const LinearTable t = random_table(random, 1e-4, 6);
        tables.component({direction, a.axis, false}) = linear_table(t.s, t.error);
        GridPoints points{{other(chain, a.axis), a.axis}, {{-1.0, 0.1, 1.0}, t.s}, {}, {}};
        for (int i = 0; i < 3; ++i) {
          points.error.insert(points.error.end(), t.error.begin(), t.error.end());
        }
        grids.component({direction, a.axis, false}) = grid(points);
      }
    }
    const VolumetricModel by_table(chain, tables), by_grid(chain, grids);
    for (int n = 0; n < 4; ++n) {
      const Joints Q = random_joints(chain, random);
      const Vector3d p_ST = 0.2 * random.vector();
      const VolumetricError one = by_table.error(Q, p_ST), two = by_grid.error(Q, p_ST);
      ASSERT_LT((one.dp_W - two.dp_W).norm(), kRounding);
      ASSERT_LT((one.dk_W - two.dk_W).norm(), kRounding);
      ASSERT_LT((by_table.joint_offset(Q, p_ST) - by_grid.joint_offset(Q, p_ST)).norm(), 1e-14);
    }
  });
}

ErrorModel smooth_grids(const MachineChain& chain, Uniform& random, double size) {
  ErrorModel errors = random_errors(random, size);
  for (const ChainAxis& a : chain.axes) {
    for (const Axis direction : kAllAxes) {
      ErrorFunction& f = errors.component({direction, a.axis, false});
      GridPoints points{{other(chain, a.axis), a.axis},
                        {{-2, -1, 0, 1, 2}, {-2, -1, 0, 1, 2}},
                        {},
                        GridInterpolation::cubic};
      for (int n = 0; n < 25; ++n) points.error.push_back(size * random());
      f = f + grid(points);
    }
  }
  return errors;
}

TEST(GridErrorLaws, JacobianHasTheSlopesOverTheOtherAxes) {
  for_machines(62, [](const MachineChain& chain, Uniform& random) {
    const double h = 1e-4, truncation = 1e-7;  // h^2/6 times third derivatives of some 10 errors
    const VolumetricModel model(chain, smooth_grids(chain, random, 1e-2));
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector();
    const PoseJacobian J = model.jacobian(Q, p_ST);
    for (const ChainAxis& a : chain.axes) {
      Joints up = Q, down = Q;
      up[a.joint] += h;
      down[a.joint] -= h;
      const ToolPose P_up = model.forward(up, p_ST), P_down = model.forward(down, p_ST);
      ASSERT_LT((J.J_pQ.col(a.joint) - (P_up.p_WT - P_down.p_WT) / (2 * h)).norm(), truncation);
      ASSERT_LT((J.J_kQ.col(a.joint) - (P_up.k_W - P_down.k_W) / (2 * h)).norm(), truncation);
    }
  });
}

TEST(GridErrorLaws, ForwardOfNonidealInverseIsIdentity) {
  for_machines(63, [](const MachineChain& chain, Uniform& random) {
    if (number_of_linear_axes(chain) < 3) return;
    const VolumetricModel model(chain, smooth_grids(chain, random, 1e-4));
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector(), p_WT = model.forward(Q, p_ST).p_WT;
    Joints near = Q;
    for (int j = 0; j < kLinearJoints; ++j) near[j] += 0.01 * random();
    const auto back = model.inverse(p_WT, near, p_ST);
    ASSERT_TRUE(back);
    ASSERT_LE((model.forward(*back, p_ST).p_WT - p_WT).norm(), 1e-12);
  });
}

TEST(GridErrorLaws, ExactMinusFirstOrderShrinksWithTheSquareOfTheErrors) {
  double sum_1 = 0.0, sum_2 = 0.0;
  for_machines(64, [&](const MachineChain& chain, Uniform& random) {
    const ErrorModel errors = smooth_grids(chain, random, 1e-3);
    const Joints Q = random_joints(chain, random);
    const Vector3d p_ST = 0.2 * random.vector();
    const auto rest = [&](double factor) {
      const VolumetricModel model(chain, scaled(errors, factor));
      return (model.error(Q, p_ST).dp_W - model.first_order_error(Q, p_ST).dp_W).norm();
    };
    sum_1 += rest(1.0);
    sum_2 += rest(0.5);
  });
  EXPECT_NEAR(sum_1 / sum_2, 4.0, 0.15);
}

}  // namespace
}  // namespace servomill::plant::grid_errors_test
