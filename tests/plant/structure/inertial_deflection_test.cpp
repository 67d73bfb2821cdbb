/// Deflection of the structure under the acceleration of the axes.
#include "plant/structure/inertial_deflection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/drives/cvode_drive.h"
#include "plant/vocabulary/units.h"
#include "tests/plant/drives/drives.h"

namespace servomill::plant::inertial_deflection_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kX = 0, kY = 1, kZ = 2;
constexpr Mode kMode{2.0 * kPi * 60.0, 0.05};

Joints only(int joint, double value) {
  Joints Q = Joints::Zero();
  Q[joint] = value;
  return Q;
}

TEST(InertialDeflection, of_a_static_pair_is_minus_k_a) {
  InertialDeflection structure({{.direction = kY, .joint = kX, .gain = 2.0 * um}}, kTick, {10});
  structure.start(Joints::Zero());
  structure.advance(Joints::Zero(), only(kX, 0.1), 10);
  ASSERT_TRUE(structure.needs_acceleration());
  const Eigen::Vector3d e = structure.at(only(kX, 3.0));
  EXPECT_TRUE(e.isApprox(Eigen::Vector3d(0.0, -6.0 * um, 0.0), 1e-15)) << e.transpose();
}

TEST(InertialDeflection, gain_changes_with_the_position_of_one_axis) {
  const InertialCompliance pair{
      .direction = kX, .joint = kX, .gain = 1.0 * um, .gain_slope = 2.0 * um, .along = kZ};
  InertialDeflection structure({pair}, kTick, {10});
  structure.start(only(kZ, 0.25));
  EXPECT_NEAR(structure.at(only(kX, 1.0)).x(), -1.5 * um, 1e-18);
  structure.advance(only(kZ, -0.25), Joints::Zero(), 10);
  EXPECT_NEAR(structure.at(only(kX, 1.0)).x(), -0.5 * um, 1e-18);
}

TEST(InertialDeflection, sums_what_several_axes_do) {
  InertialDeflection structure({{.direction = kX, .joint = kX, .gain = 1.0 * um},
                                {.direction = kX, .joint = kY, .gain = -0.5 * um},
                                {.direction = kZ, .joint = kY, .gain = 0.25 * um}},
                               kTick, {10});
  structure.start(Joints::Zero());
  Joints ddQ = Joints::Zero();
  ddQ[kX] = 2.0;
  ddQ[kY] = 4.0;
  EXPECT_LE((structure.at(ddQ) - Eigen::Vector3d(0.0, 0.0, -1.0 * um)).norm(), 1e-18);
}

// Two masses with a spring between: the slide is a mode of full participation (k = 1/w^2) on its
// motor, and CVODE integrates both. The motion of the motor alone gives the wind-up.
TEST(InertialDeflection, agrees_with_cvode_on_two_masses_to_a_tenth_of_a_nanometre) {
  FeedDriveParams p = x_axis();
  p.b_load = 0.0;
  p.k = p.M * kMode.w * kMode.w;
  p.c = p.M * 2.0 * kMode.zeta * kMode.w;
  const InertialCompliance pair{
      .direction = kX, .joint = kX, .gain = 1.0 / (kMode.w * kMode.w), .mode = kMode};
  CvodeDrive cvode(p);
  for (const Tick hold : {5, 10, 20}) {
    InertialDeflection structure({pair}, kTick, {hold});
    LaneState s = at_rest(p, 0.1);
    structure.start(only(kX, 0.1));
    double worst = 0.0, most = 0.0;
    for (int n = 0; n < 400; ++n) {
      const double t = n * static_cast<double>(hold) * kTick;
      cvode.advance(s, 20.0 * std::sin(2.0 * kPi * 25.0 * t), 0.0,
                    static_cast<double>(hold) * kTick);
      structure.advance(only(kX, s.x + s.delta), only(kX, p.r * s.w), hold);
      const double tip = structure.at(Joints::Zero()).x();
      worst = std::max(worst, std::abs(tip + s.delta));
      most = std::max(most, std::abs(tip));
    }
    EXPECT_GT(most, 10.0 * um);
    EXPECT_LE(worst, 0.1 * nm) << hold;
    RecordProperty("worst_nm", std::to_string(worst / nm));
  }
}

// Steps of different lengths in turn end where equal ones do.
TEST(InertialDeflection, takes_the_steps_of_a_schedule_in_any_order) {
  const InertialCompliance pair{.direction = kX, .joint = kX, .gain = 1.0 * um, .mode = kMode};
  constexpr double a = 3.0;  // m/s^2
  const auto after = [&](const std::vector<Tick>& turn) {
    InertialDeflection structure({pair}, kTick, turn);
    structure.start(Joints::Zero());
    for (Tick n = 0; n < 1000;) {
      for (const Tick step : turn) {
        n += step;
        const double t = static_cast<double>(n) * kTick;
        structure.advance(only(kX, 0.5 * a * t * t), only(kX, a * t), step);
      }
    }
    return structure.at(Joints::Zero()).x();
  };
  EXPECT_NEAR(after({9, 1, 10}), after({10}), 1e-15);
}

}  // namespace
}  // namespace servomill::plant::inertial_deflection_test
