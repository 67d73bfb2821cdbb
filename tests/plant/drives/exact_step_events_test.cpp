// Events within the steps of a drive, by closed forms: the slide stops and breaks away, flanks make
// and lose contact, the cogging force pulls.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/drives/exact_step.h"
#include "tests/plant/drives/single_drive.h"

namespace servomill::plant::exact_step_events_test {
namespace {

// --- set-valued friction ---------------------------------------------------------------------

TEST(SetValued, ASlidingMassStopsWhereCoulombSaysAndStays) {
  constexpr double kStopTol = 1e-14;  // m, rounding of 200 steps
  const FeedDriveParams p = bare_mass_with_coulomb();
  const ExactStep drive(p, kTick, kStep);
  const double v = 0.1, a = p.friction.Fc_positive / p.slide_mass();
  const double stop_time = v / a;
  LaneState s = moving(p, v);
  int n = 0;
  while (s.v > 0.0 && n < 1000) {
    drive.advance(s, 0.0, 0.0, kStep);
    ++n;
  }
  EXPECT_EQ(n, static_cast<int>(std::ceil(stop_time / (kStep * kTick))));
  EXPECT_NEAR(s.x, v * v / (2 * a), kStopTol);
  EXPECT_EQ(s.slide, SlideMode::sticking);
  const LaneState stopped = s;
  s = run(drive, s, 1000, kStep, constant_inputs(0.0));
  EXPECT_EQ(s.x, stopped.x);
  EXPECT_EQ(s.v, 0.0);
}

TEST(SetValued, DirectionsDecelerateWithTheirOwnForce) {
  constexpr double kStopTol = 1e-14;  // m
  FeedDriveParams p = bare_mass_with_coulomb();
  p.friction.Fc_negative = p.friction.Fs_negative = 150;
  const ExactStep drive(p, kTick, kStep);
  for (const double v : {0.05, -0.05}) {
    const LaneState s = run(drive, moving(p, v), 400, kStep, constant_inputs(0.0));
    const double Fc = v > 0 ? 450 : 150;
    EXPECT_NEAR(s.x, std::copysign(v * v * p.slide_mass() / (2 * Fc), v), kStopTol);
  }
}

TEST(SetValued, AReversalUnderForceIsTwoParabolas) {
  constexpr double kPositionTol = 1e-13;  // m, the event located to 1e-3 of 10 ns
  const FeedDriveParams p = bare_mass_with_coulomb();
  const ExactStep drive(p, kTick, kStep);
  const double v = 0.0123, F = 1000, T = 0.05;  // the force drives towards -x
  const double a1 = (F + 450) / p.slide_mass(), a2 = (F - 450) / p.slide_mass();
  const double t1 = v / a1;
  const LaneState s = run(drive, moving(p, v), 250, kStep, constant_inputs(0.0, F));
  EXPECT_NEAR(s.x, v * v / (2 * a1) - 0.5 * a2 * (T - t1) * (T - t1), kPositionTol);
}

TEST(SetValued, BreaksAwayAtFsAndNotBefore) {
  for (const double side : {1.0, -1.0}) {
    FeedDriveParams p = bare_mass(FrictionKind::set_valued);
    p.friction.Fs_negative = 500;
    const ExactStep drive(p, kTick, kStep);
    const double Fs = side > 0 ? p.friction.Fs_positive : p.friction.Fs_negative;
    LaneState s = run(drive, {}, 1000, kStep, constant_inputs(0.0, -side * Fs));
    EXPECT_EQ(s.x, 0.0);
    EXPECT_EQ(s.slide, SlideMode::sticking);
    s = run(drive, s, 1, kStep, constant_inputs(0.0, -side * Fs * (1 + 1e-12)));
    EXPECT_GT(side * s.v, 0.0);
  }
}

TEST(SetValued, BreaksAwayWhenTheWoundUpScrewReachesFs) {
  // the screw turns slowly; the slide leaves when k delta + c d(delta)/dt = Fs
  FeedDriveParams p = x_axis_with(FrictionKind::set_valued);
  p.J = 1e12;  // turns evenly, whatever the spring does
  p.b_motor = 0.0;
  const double w = 1e-3, rate = p.r * w;
  const double expected = (p.friction.Fs_positive - p.c * rate) / (p.k * rate);
  const ExactStep drive(p, kTick, 1);
  LaneState s;
  s.w = w;
  int n = 0;
  for (; s.v == 0.0 && n < 200000; ++n) drive.advance(s, 0.0, 0.0, 1);
  EXPECT_EQ(n, static_cast<int>(std::ceil(expected / kTick)));
}

TEST(SetValued, HoldsEightyPercentOfBreakawayForAThousandSecondsExactly) {
  FeedDriveParams p = x_axis_with(FrictionKind::set_valued);
  const ExactStep drive(p, kTick, 100);
  LaneState s;
  s.x = 0.25;
  s = run(drive, s, 2000, 100, constant_inputs(0.0, 0.8 * 560));
  const double settled = s.x;
  EXPECT_EQ(settled, 0.25);
  s = run(drive, s, 1000000, 100, constant_inputs(0.0, 0.8 * 560));
  EXPECT_EQ(s.x, settled);
  EXPECT_EQ(s.v, 0.0);
}

TEST(SetValued, SticksAndSlipsLikeTheMassOnAPulledSpring) {
  // Coulomb friction with Fs > Fc; the Stribeck speed is so small that g falls at once to Fc. After
  // breakaway in the frame of the spring's end: x'' = -W^2 (x - V t) + ..., and the slide stops
  // again after the time 2 (pi - atan(W dF / (k V))) / W.
  constexpr double kPeriodTol = 2e-4;  // s, the fall of g takes part of the slip
  FeedDriveParams p = x_axis_with(FrictionKind::set_valued);
  p.J = 1e9;
  p.b_motor = p.b_load = p.c = 0.0;
  p.friction.vs = 1e-7;
  const double V = 2e-4, dF = 110, W = std::sqrt(p.k / p.M);
  const double slip = 2 * (std::numbers::pi - std::atan(W * dF / (p.k * V))) / W;
  const double stick = 2 * dF / (p.k * V);
  const ExactStep drive(p, kTick, 1);
  LaneState s;
  s.w = V / p.r;
  std::vector<double> starts, stops;
  bool slid = false;
  for (int n = 0; n < 10000; ++n) {
    drive.advance(s, 0.0, 0.0, 1);
    const bool slides = s.v != 0.0;
    if (slides != slid) (slides ? starts : stops).push_back(n * kTick);
    slid = slides;
  }
  ASSERT_GE(starts.size(), 3U);
  EXPECT_NEAR(stops[1] - starts[1], slip, kPeriodTol);
  EXPECT_NEAR(starts[2] - stops[1], stick, kPeriodTol);
}

TEST(SetValued, ARigidDriveFeelsItsCurrentAtOnceWhenNothingLags) {
  constexpr double kPositionTol = 1e-15;  // m
  FeedDriveParams p = bare_mass_with_coulomb();
  p.Kt = 2.0;
  const ExactStep drive(p, kTick, kStep);
  LaneState s = run(drive, {}, 10, kStep, constant_inputs(0.99 * 450 / p.Kt));
  EXPECT_EQ(s.x, 0.0);
  s = run(drive, s, 50, kStep, constant_inputs(2.0 * 450 / p.Kt));
  EXPECT_EQ(s.i, 450.0);
  EXPECT_NEAR(s.x, 0.5 * 450 / p.slide_mass() * 1e-4, kPositionTol);  // after 10 ms
}

// --- backlash --------------------------------------------------------------------------------

// Motor and slide fly and bounce between the flanks; nothing else acts.
FeedDriveParams bouncing(double c) {
  FeedDriveParams p = x_axis();
  p.b_motor = p.b_load = 0.0;
  p.c = c;
  p.gap = 20e-6;
  return p;
}

double approach(const FeedDriveParams& p, const LaneState& s) { return p.r * s.w - s.v; }

TEST(Backlash, FliesFreelyAndBouncesElasticallyWithoutDamping) {
  constexpr double kWindUpTol = 2e-13;  // m after 40 bounces, each located to about 1 ps
  const FeedDriveParams p = bouncing(0.0);
  const double u = 4e-3, W = std::sqrt(p.k * (1 / p.M + p.r * p.r / p.J));
  const double flight = p.gap / u, contact = std::numbers::pi / W;
  const auto expected = [&](double t) {  // from -gap/2 at speed u
    double phase = std::fmod(t, 2 * (flight + contact)), side = 1.0;
    if (phase >= flight + contact) {
      phase -= flight + contact;
      side = -1.0;
    }
    if (phase < flight) return side * (-0.5 * p.gap + u * phase);
    return side * (0.5 * p.gap + u / W * std::sin(W * (phase - flight)));
  };
  const ExactStep drive(p, kTick, kStep);
  LaneState s;
  s.contact = ContactMode::gap;
  s.delta = -0.5 * p.gap;
  s.w = u / p.r;
  for (int n = 1; n <= 2000; ++n) {
    drive.advance(s, 0.0, 0.0, kStep);
    ASSERT_NEAR(s.delta, expected(n * kStep * kTick), kWindUpTol) << n;
  }
  EXPECT_EQ(s.control.unresolved, 0U);
}

TEST(Backlash, ADampedFlankReturnsWhatTheClosedFormSays) {
  // Contact ends where k delta + c d(delta)/dt = 0: restitution exp(-zeta W t), W_d t = pi - 2 asin
  // zeta.
  constexpr double kRestitutionTol = 1e-8;
  const FeedDriveParams p = bouncing(4e4);
  const double m = 1 / (1 / p.M + p.r * p.r / p.J);
  const double W = std::sqrt(p.k / m), zeta = p.c / (2 * m * W), root = std::sqrt(1 - zeta * zeta);
  const double expected = std::exp(-zeta / root * (std::numbers::pi - 2 * std::asin(zeta)));
  const ExactStep drive(p, kTick, 1);
  LaneState s;
  s.contact = ContactMode::gap;
  s.w = 4e-3 / p.r;
  for (int bounce = 0; bounce < 3; ++bounce) {
    const double before = approach(p, s);
    while (s.contact == ContactMode::gap) drive.advance(s, 0.0, 0.0, 1);
    while (s.contact != ContactMode::gap) drive.advance(s, 0.0, 0.0, 1);
    EXPECT_NEAR(-approach(p, s) / before, expected, kRestitutionTol);
  }
}

TEST(Backlash, AFlankThatTouchesCarriesFromTheFirstMoment) {
  constexpr double kPositionTol = 1e-16;  // m
  for (const double c : {0.0, 4e4}) {
    FeedDriveParams p = x_axis();
    p.c = c;
    FeedDriveParams with_gap = p;
    with_gap.gap = 20e-6;
    const ExactStep drive(with_gap, kTick, kStep), tight(p, kTick, kStep);
    const auto push = constant_inputs(1.0);
    const LaneState s = run(drive, at_rest(with_gap, 0.0), 50, kStep, push);
    EXPECT_NEAR(s.x, run(tight, {}, 50, kStep, push).x, kPositionTol);
    EXPECT_EQ(s.contact, ContactMode::positive);
  }
}

TEST(Backlash, AReversalLosesTheGap) {
  // The slide is held by stiction; the motor turns to and fro and carries it from either flank.
  constexpr double kLostTol = 1e-9;  // m
  FeedDriveParams p = x_axis_with(FrictionKind::set_valued);
  p.gap = 20e-6;
  p.friction.Fs_positive = p.friction.Fs_negative = 450;
  p.J = 1e12;  // rotates as commanded
  const ExactStep drive(p, kTick, 100);
  LaneState s = at_rest(p, 0.0);
  s.w = 1e-3 / p.r;
  s = run(drive, s, 2000, 100, constant_inputs(0.0));
  const double phi_there = (s.delta + s.x) / p.r;
  const double x_there = s.x;
  s.w = -s.w;
  s = run(drive, s, 2000, 100, constant_inputs(0.0));
  const double turned = phi_there - (s.delta + s.x) / p.r;
  const double wind_up = 2 * (450 + p.b_load * 1e-3) / p.k;
  EXPECT_NEAR(p.r * turned - (x_there - s.x), p.gap + wind_up, kLostTol);
}

// --- cogging ---------------------------------------------------------------------------------

TEST(Cogging, SwingsLikeAPendulumAboutItsRestPosition) {
  constexpr double kPeriodTol = 1e-9;  // relative, 12 to 20 periods
  FeedDriveParams p;
  p.kind = DriveKind::direct;
  p.J = 1.6;
  p.M = 0.9;
  p.cogging = {.T = 5.0, .n = 24.0, .phase = 0.7};
  const double rest = -p.cogging.phase / p.cogging.n;
  const double W = std::sqrt(p.cogging.T * p.cogging.n / p.slide_mass());
  const ExactStep drive(p, kTick, kStep);
  LaneState s = run(drive, {.x = rest}, 100, kStep, constant_inputs(0.0));
  EXPECT_NEAR(s.x, rest, 1e-15);
  for (const double swing : {1e-4, 2.0}) {  // n x at the turning points
    const double period = 4 * std::comp_ellint_1(std::sin(swing / 2)) / W;
    s = {.x = rest + swing / p.cogging.n};
    double before = s.x - rest, first = 0, last = 0;
    int crossings = 0;
    for (int n = 1; n < 20000; ++n) {
      drive.advance(s, 0.0, 0.0, kStep);
      if (before > 0 && s.x <= rest) {  // the force vanishes there: uniform speed
        (crossings++ ? last : first) = n * kStep * kTick - (s.x - rest) / s.v;
      }
      before = s.x - rest;
    }
    EXPECT_NEAR((last - first) / (crossings - 1), period, kPeriodTol * period) << swing;
    EXPECT_EQ(s.control.unresolved, 0U);
  }
}

}  // namespace
}  // namespace servomill::plant::exact_step_events_test
