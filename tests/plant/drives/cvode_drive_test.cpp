#include "plant/drives/cvode_drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/plant/drives/drives.h"

namespace servomill::plant::cvode_drive_test {
namespace {

constexpr double kPositionTol = 1e-14;  // m, ways below 1 m at rtol 1e-12 and rounding
constexpr double kSpeedTol = 1e-13;     // m/s, the same
constexpr double kBounceTol = 2e-12;    // m/s, oscillation between flanks, 1e-10 of its speed

// 10 kg and nothing but friction.
FeedDriveParams rigid_block(FrictionKind kind, double Fc, double Fs) {
  FeedDriveParams p;
  p.kind = DriveKind::rigid;
  p.J = 2.0;
  p.M = 8.0;
  p.friction = {.kind = kind,
                .Fc_positive = Fc,
                .Fc_negative = Fc,
                .Fs_positive = Fs,
                .Fs_negative = Fs,
                .vs = 2e-3,
                .v0 = 1e-5,
                .sigma0 = 1e5,
                .sigma1 = 0.0};
  return p;
}

// Motor and slide that float: 2 kg and 8 kg with a spring between them, r = 1.
FeedDriveParams floating_pair() {
  FeedDriveParams p;
  p.J = 2.0;
  p.M = 8.0;
  p.k = 1e6;
  return p;
}
constexpr double kReducedMass = 2.0 * 8.0 / 10.0;  // kg, of floating_pair

TEST(CvodeDrive, CoulombFrictionStopsAMassAndKeepsItStill) {
  const FeedDriveParams p = rigid_block(FrictionKind::set_valued, 30.0, 30.0);
  for (const double v0 : {0.6, -0.6}) {
    CvodeDrive drive(p);
    LaneState s;
    s.v = s.w = v0;
    const double a = 30.0 / 10.0, t_stop = std::abs(v0) / a;
    drive.advance(s, 0.0, 0.0, 0.5 * t_stop);
    EXPECT_NEAR(s.v, 0.5 * v0, kSpeedTol);
    EXPECT_EQ(s.slide, v0 > 0 ? SlideMode::positive : SlideMode::negative);
    drive.advance(s, 0.0, 0.0, t_stop);
    EXPECT_NEAR(s.x, std::copysign(0.5 * v0 * v0 / a, v0), kPositionTol);
    EXPECT_EQ(s.v, 0.0);
    EXPECT_EQ(s.w, 0.0);
    EXPECT_EQ(s.slide, SlideMode::sticking);
    const double x_stop = s.x;
    drive.advance(s, 0.0, 29.999, 10.0);
    EXPECT_EQ(s.x, x_stop);
  }
}

TEST(CvodeDrive, EachDirectionHasItsOwnFriction) {
  FeedDriveParams p = rigid_block(FrictionKind::set_valued, 30.0, 30.0);
  p.friction.Fc_negative = p.friction.Fs_negative = 60.0;
  CvodeDrive drive(p);
  LaneState forth, back;
  forth.v = forth.w = 0.6;
  back.v = back.w = -0.6;
  drive.advance(forth, 0.0, 0.0, 1.0);
  drive.advance(back, 0.0, 0.0, 1.0);
  EXPECT_NEAR(forth.x, 0.06, kPositionTol);
  EXPECT_NEAR(back.x, -0.03, kPositionTol);
}

TEST(CvodeDrive, AForceBeyondBreakawayTurnsTheSlideWithoutAStop) {
  const FeedDriveParams p = rigid_block(FrictionKind::set_valued, 30.0, 30.0);
  CvodeDrive drive(p);
  LaneState s;
  s.v = s.w = 0.6;
  const double F = 50.0, t_turn = 0.6 / ((F + 30.0) / 10.0), t_end = 0.2;
  drive.advance(s, 0.0, F, t_end);
  const double a_back = (F - 30.0) / 10.0, t_back = t_end - t_turn;
  EXPECT_NEAR(s.v, -a_back * t_back, kSpeedTol);
  EXPECT_NEAR(s.x, 0.5 * 0.6 * t_turn - 0.5 * a_back * t_back * t_back, kPositionTol);
  EXPECT_EQ(s.slide, SlideMode::negative);
}

TEST(CvodeDrive, BreaksAwayWhereARisingForceReachesFs) {
  FeedDriveParams p = rigid_block(FrictionKind::set_valued, 40.0, 40.0);
  p.L = 0.1;                       // a winding without resistance: the current is a ramp
  const double ramp = 20.0 / p.L;  // N/s
  for (const double direction : {1.0, -1.0}) {
    CvodeDrive drive(p);
    LaneState s;
    s.x = 0.3;
    drive.advance(s, direction * 20.0, 0.0, 0.19999999);
    EXPECT_EQ(s.x, 0.3);
    EXPECT_EQ(s.slide, SlideMode::sticking);
    drive.advance(s, direction * 20.0, 0.0, 0.1 + 0.00000001);
    // m dv/dt = ramp (t - t_breakaway)
    EXPECT_NEAR(s.x - 0.3, direction * ramp * std::pow(0.1, 3) / 6.0 / 10.0, 1e-13);
    EXPECT_NEAR(s.v, direction * ramp * std::pow(0.1, 2) / 2.0 / 10.0, 1e-12);
  }
}

TEST(CvodeDrive, HoldsStillForeverBelowBreakaway) {
  FeedDriveParams p = floating_pair();
  p.k = 2e8;
  p.c = 4e4;
  p.b_motor = 0.01;
  p.T_i = 0.35e-3;
  p.friction = rigid_block(FrictionKind::set_valued, 450.0, 560.0).friction;
  CvodeDrive drive(p);
  LaneState s = at_rest(p, 0.25);
  drive.advance(s, 0.8 * 560.0, 0.0, 1000.0);
  EXPECT_EQ(s.x, 0.25);
  EXPECT_EQ(s.v, 0.0);
  EXPECT_NEAR(s.delta, 0.8 * 560.0 / p.k, 1e-15);  // the motor winds the spring up
  drive.advance(s, 1.01 * 560.0, 0.0, 0.1);
  EXPECT_EQ(s.slide, SlideMode::positive);
}

TEST(CvodeDrive, WithoutFrictionForceStickingDoesNotHold) {
  FeedDriveParams p = rigid_block(FrictionKind::set_valued, 0.0, 0.0);
  p.T_i = 1e-3;
  FeedDriveParams free = p;
  free.friction = {};
  LaneState a, b;
  CvodeDrive(p).advance(a, 5.0, 0.0, 0.1);
  CvodeDrive(free).advance(b, 5.0, 0.0, 0.1);
  EXPECT_NEAR(a.x, b.x, kPositionTol);
}

TEST(CvodeDrive, RegularisedFrictionCreepsUnderLoad) {
  // Fs tanh(v / v0) = 0.8 Fs, v far below vs; 1 / (time constant) = Fs / (m v0) = 4e5 1/s
  const FeedDriveParams p = rigid_block(FrictionKind::regularised, 40.0, 40.0);
  CvodeDrive drive(p);
  LaneState s;
  drive.advance(s, 0.0, -0.8 * 40.0, 0.01);
  EXPECT_NEAR(s.v, 1e-5 * std::atanh(0.8), 1e-17);
}

TEST(CvodeDrive, LugrePreslidesAsTheBristlesBend) {
  // Moving one way with g constant, z = (g / sigma0) (1 - exp(-sigma0 x / g)); at rest sigma0 z = F
  FeedDriveParams p = rigid_block(FrictionKind::lugre, 40.0, 40.0);
  p.b_load = 2500.0;  // more than critical: no overshoot
  const double bend = 40.0 / p.friction.sigma0;
  for (const double fraction : {0.001, 0.5, 0.9}) {
    CvodeDrive drive(p);
    LaneState s;
    drive.advance(s, 0.0, -fraction * 40.0, 10.0);  // slowest decay: b / (sigma0 - F sigma0 / g)
    EXPECT_NEAR(s.z, fraction * bend, 1e-15);
    EXPECT_NEAR(s.x, -bend * std::log(1.0 - fraction), 1e-14);
    const double x_rest = s.x;
    drive.advance(s, 0.0, -fraction * 40.0, 100.0);
    EXPECT_NEAR(s.x, x_rest, 1e-15);  // bounded presliding, no creep
  }
}

TEST(CvodeDrive, LugreSlidesAtTheStribeckForce) {
  // sigma0 |v| / g = 6e4 1/s; a motion that lasts: F = g(v) + b v
  FeedDriveParams p = rigid_block(FrictionKind::lugre, 40.0, 50.0);
  p.friction.sigma0 = 5e7;
  p.friction.sigma1 = 3e3;
  p.b_load = 100.0;
  CvodeDrive drive(p);
  LaneState s;
  const double v = 0.05, g = sliding_force(p.friction, true, v);
  s.v = s.w = 2.0 * v;
  drive.advance(s, 0.0, -(g + p.b_load * v), 5.0);
  EXPECT_NEAR(s.v, v, 1e-13);
  EXPECT_NEAR(s.z, g / p.friction.sigma0, 1e-18);
}

TEST(CvodeDrive, BouncesBetweenTheFlanksWithoutLoss) {
  FeedDriveParams p = floating_pair();
  p.gap = 1e-4;
  CvodeDrive drive(p);
  LaneState s;
  s.contact = ContactMode::gap;
  s.w = 0.05;  // the motor catches the slide up
  s.v = 0.02;
  const double u = 0.03, omega = std::sqrt(p.k / kReducedMass);
  const double bounce = std::numbers::pi / omega, flight = p.gap / u;
  const double v_cm = (2.0 * 0.05 + 8.0 * 0.02) / 10.0;
  drive.advance(s, 0.0, 0.0, 0.5 * flight + 0.5 * bounce);
  EXPECT_EQ(s.contact, ContactMode::positive);
  EXPECT_NEAR(s.delta, 0.5 * p.gap + u / omega, 1e-14);  // fully compressed
  drive.advance(s, 0.0, 0.0, 0.5 * bounce + flight);
  EXPECT_NEAR(s.delta, -0.5 * p.gap, 1e-14);
  EXPECT_NEAR(p.r * s.w - s.v, -u, kBounceTol);
  drive.advance(s, 0.0, 0.0, 0.5 * bounce);
  EXPECT_EQ(s.contact, ContactMode::negative);
  drive.advance(s, 0.0, 0.0, 0.5 * bounce + 0.5 * flight);
  EXPECT_EQ(s.contact, ContactMode::gap);
  EXPECT_NEAR(s.delta, 0.0, 1e-14);
  EXPECT_NEAR(s.v, 0.02, kBounceTol);
  EXPECT_NEAR(s.x, v_cm * 2.0 * (flight + bounce), kPositionTol);
}

TEST(CvodeDrive, DampedFlanksPushButNeverPull) {
  // d'' + 2 a d' + omega^2 d = 0 from d = 0, d' = u until d'' = 0 (no force): then d' stays
  FeedDriveParams p = floating_pair();
  p.gap = 1e-4;
  p.c = 600.0;
  const double omega = std::sqrt(p.k / kReducedMass), a = 0.5 * p.c / kReducedMass;
  const double omega_d = std::sqrt(omega * omega - a * a);
  const double t =
      (std::numbers::pi - std::atan2(2.0 * a * omega_d, omega * omega - 2.0 * a * a)) / omega_d;
  const double restitution =
      -std::exp(-a * t) * (std::cos(omega_d * t) - a / omega_d * std::sin(omega_d * t));
  CvodeDrive drive(p);
  LaneState s;
  s.contact = ContactMode::gap;
  s.w = 0.03;
  for (const double duration : {0.5 * p.gap / 0.03 + 1.0001 * t, 1e-4}) {
    drive.advance(s, 0.0, 0.0, duration);
    EXPECT_EQ(s.contact, ContactMode::gap);
    EXPECT_NEAR(p.r * s.w - s.v, -restitution * 0.03, kSpeedTol);
  }
}

TEST(CvodeDrive, FlanksThatWouldPullPartAtOnce) {
  FeedDriveParams p = floating_pair();
  p.gap = 1e-4;
  CvodeDrive drive(p);
  LaneState s;  // delta = 0 but said to touch
  s.v = 0.02;
  drive.advance(s, 0.0, 0.0, 1e-3);
  EXPECT_EQ(s.contact, ContactMode::gap);
  EXPECT_EQ(s.v, 0.02);
}

TEST(CvodeDrive, ADriveWithoutLagTakesTheCommandForItsCurrent) {
  FeedDriveParams p = rigid_block(FrictionKind::set_valued, 30.0, 30.0);
  CvodeDrive drive(p);
  LaneState s;
  drive.advance(s, 29.0, 0.0, 1.0);
  EXPECT_EQ(s.x, 0.0);
  drive.advance(s, 50.0, 0.0, 1.0);
  EXPECT_NEAR(s.x, 0.5 * 2.0, kPositionTol);
}

TEST(CvodeDrive, CanBeMoved) {
  const FeedDriveParams p = rigid_block(FrictionKind::set_valued, 30.0, 30.0);
  CvodeDrive first(p);
  CvodeDrive second = std::move(first);
  LaneState s;
  s.v = s.w = 0.6;
  second.advance(s, 0.0, 0.0, 1.0);
  EXPECT_NEAR(s.x, 0.06, kPositionTol);
}

TEST(CvodeDrive, SaysWhatCvodeRefuses) {
  const FeedDriveParams p = rigid_block(FrictionKind::none, 0.0, 0.0);
  try {
    const CvodeDrive drive(p, {.relative = -1.0});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(
        error.what(),
        "CVodeSVtolerances fails with CV_ILL_INPUT: reltol < 0 illegal. (command 0, F 0 N, "
        "from i 0 A, w 0 rad/s, delta 0 m, v 0 m/s, x 0 m, z 0 m)");
  }
  CvodeDrive drive(p);
  LaneState s;
  EXPECT_THROW(drive.advance(s, std::nan(""), 0.0, 1.0), std::runtime_error);
}

// The speed by CVODE within a microsecond, extrapolated to its beginning.
TEST(CvodeDrive, SlideAccelerationIsTheDerivativeOfTheSpeed) {
  constexpr double kShort = 1e-6;            // s
  constexpr double kAccelerationTol = 1e-5;  // m/s^2, of the curvature within twice that
  for (const FrictionKind kind : {FrictionKind::none, FrictionKind::set_valued,
                                  FrictionKind::regularised, FrictionKind::lugre}) {
    for (const bool rigid : {false, true}) {
      FeedDriveParams p = x_axis_with(kind);
      if (rigid) p.kind = DriveKind::rigid;
      if (rigid) p.T_i = 0.0;
      LaneState begin = at_rest(p, 0.1);
      begin.v = -0.05;
      begin.w = begin.v / p.r;
      begin.i = rigid ? 12.0 : 8.0;
      begin.delta += rigid ? 0.0 : 20e-6;
      begin.z = -9e-6;
      begin.slide = SlideMode::negative;
      constexpr double kCommand = 12.0, kForce = 100.0;
      const auto speed_after = [&](double t) {
        CvodeDrive drive(p);
        LaneState s = begin;
        drive.advance(s, kCommand, kForce, t);
        return s.v;
      };
      const double a =
          (4.0 * speed_after(kShort) - speed_after(2.0 * kShort) - 3.0 * begin.v) / (2.0 * kShort);
      EXPECT_NEAR(slide_acceleration(p, begin, kCommand, kForce), a, kAccelerationTol)
          << int(kind) << " " << rigid;
    }
  }
}

TEST(CvodeDrive, SlideThatSticksDoesNotAccelerate) {
  const FeedDriveParams p = x_axis_with(FrictionKind::set_valued);
  LaneState s = at_rest(p, 0.1);
  s.delta += 1e-6;  // 220 N, below the breakaway force
  EXPECT_EQ(slide_acceleration(p, s, 0.0, 0.0), 0.0);
}

}  // namespace
}  // namespace servomill::plant::cvode_drive_test
