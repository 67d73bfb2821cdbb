/// Structure that forces of the cut bend across their direction, in whole runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>

#include "plant/vocabulary/units.h"
#include "tests/sim/cutting_block.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::structural_run_test {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

const std::string kFine = "[record]\nperiod_ms = 0.1\nresolution_nm = 0.0\n";
const std::string kTeeth = kSteel + "force = \"instantaneous\"\n";

std::string modes(const std::string& list) {
  return "[machine_override]\nstructural_mode = [" + list + "]\n";
}

records::Series servo_of(const std::string& text) {
  return run_named_case(small_scenario(kSlot, kTool + kBlock + text + kFine + one_case("cut")),
                        "cut")
      .result.servo;
}

Vector3d vector_of(const records::Series& servo, const char* name, std::size_t row) {
  const std::size_t column = *servo.column(name, 'X');
  return {servo.at(row, column), servo.at(row, column + 1), servo.at(row, column + 2)};
}

// Static: C F with C = c u u^T, symmetric, at every instant.
TEST(StructuralRun, force_along_one_axis_displaces_the_tip_along_others) {
  const records::Series servo =
      servo_of(kSteel + modes("{ direction = [0.8, 0.6, 0.0], stiffness = 5e7 }"));
  const Vector3d u(0.8, 0.6, 0.0);
  const Eigen::Matrix3d C = 1.0 / 50.0 * u * u.transpose();  // um/N
  double most = 0.0;
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    const Vector3d F = vector_of(servo, "cutting_force", n),
                   d = vector_of(servo, "structural_deflection", n);
    ASSERT_LE((d - C * F).norm(), 1e-12);
    most = std::max(most, std::abs(d.x() - 0.64 / 50.0 * F.x()));
  }
  EXPECT_GT(most, 1.0);  // um along X, by the force along Y
}

// A mode under the force of single teeth, which is held step by step: the matrix exponential.
TEST(StructuralRun, mode_follows_the_force_of_single_teeth_exactly) {
  const double w = 2.0 * kPi * 95.0, zeta = 0.06, c = 1.0 / 20.0;  // rad/s, um/N
  const records::Series servo = servo_of(
      kTeeth + modes("{ direction = [0.6, 0.0, 0.8], stiffness = 2e7, frequency_Hz = 95.0, damping "
                     "= 0.06 }"));
  const Vector3d u(0.6, 0.0, 0.8);
  Eigen::Matrix3d A;  // q, dq/dt, c u F
  A << 0.0, 1.0, 0.0, -w * w, -2.0 * zeta * w, w * w, 0.0, 0.0, 0.0;
  const Eigen::Matrix3d step = (A * (0.1 * ms)).exp();
  Vector3d state = Vector3d::Zero();
  double most = 0.0, worst = 0.0;
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    const Vector3d d = vector_of(servo, "structural_deflection", n);
    worst = std::max(worst, (d - state[0] * u).norm());
    most = std::max(most, d.norm());
    state[2] = c * u.dot(vector_of(servo, "cutting_force", n));
    state = step * state;
  }
  EXPECT_GT(most, 1.0);
  EXPECT_LE(worst, 1e-9 * most);
}

// Static modes along the axes are what structural_stiffness is, in balance with the depth of cut.
TEST(StructuralRun, modes_along_the_axes_are_structural_stiffnesses) {
  const std::string actual = kSteel + "depth_of_cut = \"actual\"\n";
  const records::Series by_keys =
      servo_of(actual +
               "[machine_override.axis.X]\nstructural_stiffness = 5e7\n"
               "[machine_override.axis.Y]\nstructural_stiffness = 4e7\n"
               "[machine_override.axis.Z]\nstructural_stiffness = 2e7\n");
  const records::Series by_modes =
      servo_of(actual + modes("{ direction = [1.0, 0.0, 0.0], stiffness = 5e7 },"
                              "{ direction = [0.0, 2.0, 0.0], stiffness = 4e7 },"
                              "{ direction = [0.0, 0.0, -1.0], stiffness = 2e7 }"));
  ASSERT_EQ(by_keys.rows(), by_modes.rows());
  for (std::size_t n = 0; n < by_keys.rows(); ++n) {
    for (const char* signal : {"cutting_force", "structural_deflection", "tool_deviation"}) {
      ASSERT_LE((vector_of(by_keys, signal, n) - vector_of(by_modes, signal, n)).norm(), 1e-9)
          << signal << " " << n;
    }
  }
}

// Far above the passage of the teeth a mode is static.
TEST(StructuralRun, mode_far_above_the_teeth_is_nearly_static) {
  const auto deflection = [](const std::string& more) {
    return servo_of(kSteel + modes("{ direction = [0.8, 0.6, 0.0], stiffness = 5e7" + more + " }"));
  };
  const records::Series fixed = deflection(""),
                        fast = deflection(", frequency_Hz = 500.0, damping = 0.3");
  const auto rows = rows_within(fixed, -5.0, 10.0);
  for (const std::size_t n : rows) {
    const Vector3d d = vector_of(fixed, "structural_deflection", n);
    ASSERT_LE((vector_of(fast, "structural_deflection", n) - d).norm(), 1e-3 * d.norm());
  }
}

}  // namespace
}  // namespace servomill::sim::engine::structural_run_test
