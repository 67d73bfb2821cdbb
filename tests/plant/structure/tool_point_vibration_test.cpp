#include "plant/structure/tool_point_vibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::plant::tool_point_vibration_test {
namespace {

using Eigen::Vector3d;

constexpr double kStep = 50 * us;
const StructuralMode kY{.direction = Vector3d::UnitY(),
                        .compliance = 1.0 / 20e6,
                        .mode = {2.0 * std::numbers::pi * 500.0, 0.03}};

// q of a mode at rest whose force begins at t = 0.
double step_response(const StructuralMode& mode, double force, double t) {
  const double w = mode.mode.w, z = mode.mode.zeta, wd = w * std::sqrt(1.0 - z * z);
  return force * mode.compliance *
         (1.0 - std::exp(-z * w * t) * (std::cos(wd * t) + z * w / wd * std::sin(wd * t)));
}

TEST(ToolPointVibration, under_a_constant_force_is_the_step_response) {
  ToolPointVibration vibration({kY}, kStep);
  const Vector3d force(300.0, 200.0, 0.0);  // that along Y counts
  for (int n = 0; n < 400; ++n) {
    const double q = step_response(kY, 200.0, n * kStep);
    EXPECT_LT((vibration.now().x - Vector3d(0.0, q, 0.0)).norm(), 1e-15) << n;
    vibration.advance(force);
  }
}

TEST(ToolPointVibration, ends_a_step_where_it_was_predicted) {
  StructuralMode oblique = kY;
  oblique.direction = Vector3d(0.6, 0.0, 0.8);
  oblique.mode.w *= 1.7;
  ToolPointVibration vibration({kY, oblique}, kStep);
  for (int n = 0; n < 50; ++n) {
    const Vector3d force(10.0 * n, 100.0 - n, 5.0);
    const ToolPointVibration::State next = vibration.after(force);
    vibration.advance(force);
    EXPECT_EQ(vibration.now().x, next.x);
    EXPECT_EQ(vibration.now().dx, next.dx);
  }
}

TEST(ToolPointVibration, between_two_steps_is_cubic) {
  const auto cubic = [](double t) { return Vector3d(1.0, t, 2.0 * t * t - t * t * t); };
  const auto rate = [](double t) { return Vector3d(0.0, 1.0, 4.0 * t - 3.0 * t * t); };
  constexpr double kBegin = 0.3, kLength = 0.4;
  for (const double share : {0.0, 0.2, 0.5, 1.0}) {
    const Vector3d x = ToolPointVibration::between(
        {cubic(kBegin), rate(kBegin)}, {cubic(kBegin + kLength), rate(kBegin + kLength)}, kLength,
        share);
    EXPECT_LT((x - cubic(kBegin + share * kLength)).norm(), 1e-14) << share;
  }
}

}  // namespace
}  // namespace servomill::plant::tool_point_vibration_test
