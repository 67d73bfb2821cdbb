// The volumetric error of three linear axes next to the formula of the virtual encoder against
// which speed is measured (tests/bench): equal to second order in the errors.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/units.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::reference_virtual_encoder_test {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 2e-15;  // m: some tens of operations on numbers below 2

const MachineChain kChain = make_chain(parse_structure("[w b X Y Z t]"));

using Cubic = std::array<double, 4>;
// d and e of X, Y, Z in the order dx dy dz ex ey ez.
constexpr Cubic kCubics[3][6] = {{{0, 2.1e-5, -6.0e-5, 1.1e-4},
                                  {0, -8.0e-6, 4.5e-5, -7.0e-5},
                                  {0, 5.0e-6, -3.2e-5, 9.0e-5},
                                  {0, 1.8e-5, -5.5e-5, 6.0e-5},
                                  {0, -2.4e-5, 7.0e-5, -8.0e-5},
                                  {0, 1.5e-5, 3.0e-5, -4.0e-5}},
                                 {{0, -6.0e-6, 2.8e-5, 5.0e-5},
                                  {0, 1.7e-5, -4.1e-5, 8.0e-5},
                                  {0, 9.0e-6, 2.2e-5, -6.0e-5},
                                  {0, -2.0e-5, 4.0e-5, 7.0e-5},
                                  {0, 1.2e-5, -3.5e-5, 5.0e-5},
                                  {0, 2.2e-5, -6.0e-5, -3.0e-5}},
                                 {{0, 4.0e-6, -1.9e-5, 6.0e-5},
                                  {0, -7.0e-6, 3.1e-5, -5.0e-5},
                                  {0, -1.9e-5, 5.2e-5, 7.0e-5},
                                  {0, 1.1e-5, 2.7e-5, -6.0e-5},
                                  {0, -1.6e-5, 4.4e-5, 3.0e-5},
                                  {0, 1.3e-5, -2.9e-5, 4.0e-5}}};
constexpr double kSxy = 1.5e-5, kSxz = -1.1e-5, kSyz = 0.9e-5;  // rad
const Vector3d kTool{0.0, 0.0, -0.15};

ErrorModel reference_errors() {
  ErrorModel errors;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t d = 0; d < 6; ++d) {
      const Cubic& c = kCubics[axis][d];
      errors.components[axis][d] = polynomial({c[0], c[1], c[2], c[3]});
    }
  }
  errors.location("EC0Y"_err) = kSxy;
  errors.location("EB0Z"_err) = kSxz;
  errors.location("EA0Z"_err) = kSyz;
  return errors;
}

// E as the reference writes it, with matrices 1 + [e]x, all errors multiplied by h.
Vector3d reference_E(const Vector3d& p, double h) {
  Vector3d v = kTool;
  for (int axis = 2; axis >= 0; --axis) {
    Eigen::Matrix<double, 6, 1> e;
    for (int d = 0; d < 6; ++d) {
      const Cubic& c = kCubics[axis][d];
      const double s = p[axis];
      e[d] = h * (c[0] + c[1] * s + c[2] * s * s + c[3] * s * s * s);
    }
    v += e.tail<3>().cross(v).eval() + e.head<3>();
    v[axis] += p[axis];
    if (axis == 1) v.x() -= h * kSxy * p.y();
    if (axis == 2) v += Vector3d(h * kSxz * p.z(), -h * kSyz * p.z(), 0.0);
  }
  return v - p - kTool;
}

TEST(ReferenceVirtualEncoder, AgreesWithOursToSecondOrder) {
  Uniform random(21);
  for (int i = 0; i < 50; ++i) {
    const Vector3d p = 0.2 * random.vector();
    Joints Q = Joints::Zero();
    Q.head<3>() = p;
    // With h = 256 the errors are so large that second order stands clear of rounding.
    const auto miss = [&](double h) {
      const ErrorModel errors = scaled(reference_errors(), h);
      return Vector3d(volumetric_error(kChain, errors, Q, kTool).dp_W - reference_E(p, h));
    };
    const auto first_order_miss = [&](double h) {
      const ErrorModel errors = scaled(reference_errors(), h);
      return Vector3d(first_order_volumetric_error(kChain, errors, Q, kTool).dp_W -
                      reference_E(p, h));
    };
    // Second order falls to a quarter, so four quarters leave only third order: (1e-5 h)^3.
    const double third_order = std::pow(1e-5 * 256.0, 3);
    EXPECT_LT((4.0 * miss(128.0) - miss(256.0)).norm(), third_order);
    EXPECT_LT((4.0 * first_order_miss(128.0) - first_order_miss(256.0)).norm(), third_order);
    // As the numbers stand the choice of the rotation does not matter.
    EXPECT_LT(miss(1.0).norm(), 0.1 * nm);
  }
}

TEST(ReferenceVirtualEncoder, IsOurFirstOrderErrorInTheLimit) {
  const VolumetricModel model(kChain, reference_errors());
  Uniform random(22);
  for (int i = 0; i < 50; ++i) {
    const Vector3d p = 0.2 * random.vector();
    Joints Q = Joints::Zero();
    Q.head<3>() = p;
    // 4 f(1/2) - f(1) = f'(0) + third order
    const Vector3d linear = 4.0 * reference_E(p, 0.5) - reference_E(p, 1.0);
    EXPECT_LT((model.first_order_error(Q, kTool).dp_W - linear).norm(), kRounding);
  }
}

}  // namespace
}  // namespace servomill::plant::reference_virtual_encoder_test
