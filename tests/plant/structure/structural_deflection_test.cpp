/// Deflection by forces at the tip against closed forms and the laws of Maxwell and Betti.
#include "plant/structure/structural_deflection.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <vector>

namespace servomill::plant::structural_deflection_test {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

std::vector<StructuralMode> modes() {
  return {{Vector3d(0.8, 0.6, 0.0), 2e-8, {}},
          {Vector3d(0.0, 0.6, -0.8), 1e-8, {2.0 * kPi * 60.0, 0.04}},
          {Vector3d(1.0, 1.0, 1.0).normalized(), 3e-8, {2.0 * kPi * 45.0, 0.1}}};
}

// Response to the force F, which is there from the beginning.
Vector3d step_response(const Vector3d& F, double t) {
  StructuralDeflection d(modes());
  d.advance(0.0, F);
  return d.after(t);
}

// Maxwell and Betti: along X by a force along Y as along Y by the same along X, at any time.
TEST(StructuralDeflection, is_symmetric_at_any_time) {
  for (const double t : {0.0, 1e-3, 7e-3, 0.1, 10.0}) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const double ij = step_response(Vector3d::Unit(j), t)[i];
        const double ji = step_response(Vector3d::Unit(i), t)[j];
        EXPECT_NEAR(ij, ji, 1e-22) << t;
      }
    }
  }
  EXPECT_GT(std::abs(step_response(Vector3d::UnitX(), 0.1)[1]), 1e-9);
}

TEST(StructuralDeflection, ends_at_the_sum_of_the_compliances_and_stores_energy) {
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
  for (const StructuralMode& one : modes()) {
    C += one.compliance * one.direction * one.direction.transpose();
  }
  const Vector3d F(300.0, -200.0, 150.0);
  EXPECT_LE((step_response(F, 10.0) - C * F).norm(), 1e-12 * (C * F).norm());
  EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(C).eigenvalues().minCoeff(), 0.0);
}

// Step response 1 - exp(-zeta w t)(cos w_d t + zeta w / w_d sin w_d t), however it is cut up.
TEST(StructuralDeflection, of_a_mode_is_its_step_response_in_steps_of_any_length) {
  const StructuralMode mode = modes()[1];
  const double w = mode.mode.w, zeta = mode.mode.zeta, w_d = w * std::sqrt(1.0 - zeta * zeta);
  StructuralDeflection d({mode});
  const Vector3d F(0.0, 100.0, 0.0);
  d.advance(0.0, F);
  double t = 0.0;
  for (int n = 0; n < 400; ++n) {
    const double dt = n % 3 == 0 ? 1e-4 : 3.7e-4;
    d.advance(dt, F);
    t += dt;
    const double q =
        mode.compliance * mode.direction.dot(F) *
        (1.0 - std::exp(-zeta * w * t) * (std::cos(w_d * t) + zeta * w / w_d * std::sin(w_d * t)));
    ASSERT_LE((d.after(0.0) - q * mode.direction).norm(), 1e-18) << t;
    ASSERT_EQ(d.of_modes(), d.after(0.0));
  }
}

// Work of the force = energy of spring and mass + what the damper took; per mode with unit
// stiffness 1/c and mass 1/(c w^2). F is held: its work is F . (d(end) - d(begin)).
TEST(StructuralDeflection, balances_the_work_of_the_force) {
  const StructuralMode mode = modes()[2];
  const double w = mode.mode.w;
  StructuralDeflection d({mode});
  double work = 0.0, dissipated = 0.0, turnover = 0.0;
  constexpr double h = 1e-6;
  double q = 0.0, dq = 0.0;
  const auto coordinate = [&] { return mode.direction.dot(d.after(0.0)); };
  const auto speed = [&] {  // by differences of order 4
    const Vector3d sum = -25.0 * d.after(0.0) + 48.0 * d.after(h) - 36.0 * d.after(2.0 * h) +
                         16.0 * d.after(3.0 * h) - 3.0 * d.after(4.0 * h);
    return mode.direction.dot(sum) / (12.0 * h);
  };
  for (int n = 0; n < 300; ++n) {
    const Vector3d F = 100.0 * Vector3d(std::sin(0.3 * n), std::cos(0.11 * n), 0.5);
    d.advance(0.0, F);
    const double before = coordinate();
    // the damper, by Simpson's rule over tenths of the step of 1e-4 s
    for (int k = 0; k < 10; ++k) {
      double rate[3];
      rate[0] = speed();
      d.advance(5e-6, F);
      rate[1] = speed();
      d.advance(5e-6, F);
      rate[2] = speed();
      const double c = 2.0 * mode.mode.zeta / (w * mode.compliance);
      dissipated +=
          1e-5 / 6.0 * c * (rate[0] * rate[0] + 4.0 * rate[1] * rate[1] + rate[2] * rate[2]);
    }
    const double done = mode.direction.dot(F) * (coordinate() - before);
    work += done;
    turnover += std::abs(done);
    q = coordinate();
    dq = speed();
  }
  const double stored = 0.5 / mode.compliance * (q * q + dq * dq / (w * w));
  EXPECT_GT(dissipated, 0.05 * turnover);
  EXPECT_LE(std::abs(work - stored - dissipated), 1e-9 * turnover);
}

TEST(StructuralDeflection, without_modes_is_none) {
  StructuralDeflection d;
  EXPECT_TRUE(d.is_rigid());
  d.advance(1.0, Vector3d(1.0, 2.0, 3.0));
  EXPECT_TRUE(d.after(1.0).isZero(0.0));
  EXPECT_FALSE(StructuralDeflection(modes()).is_rigid());
}

}  // namespace
}  // namespace servomill::plant::structural_deflection_test
