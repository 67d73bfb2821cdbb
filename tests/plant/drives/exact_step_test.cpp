#include "plant/drives/exact_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "tests/plant/drives/drives.h"

namespace servomill::plant::exact_step_test {
namespace {

constexpr Tick kStep = 20;  // 200 us
constexpr double kNanometre = 1e-9;

// A mass of 100 kg without anything else.
FeedDriveParams bare_mass(FrictionKind kind) {
  FeedDriveParams p;
  p.kind = DriveKind::rigid;
  p.r = 1.0;
  p.J = 40;
  p.M = 60;
  p.friction = friction(kind);
  return p;
}

FeedDriveParams bare_mass_with_coulomb() {
  FeedDriveParams p = bare_mass(FrictionKind::set_valued);
  p.friction.Fs_positive = p.friction.Fc_positive;
  p.friction.Fs_negative = p.friction.Fc_negative;
  return p;
}

// A rigid drive whose state is set to move at v.
LaneState moving(const FeedDriveParams& p, double v) {
  LaneState s;
  s.v = v;
  s.w = v / p.r;
  return s;
}

using Inputs = std::function<std::array<double, 2>(double)>;  // t -> command, F

LaneState run(const ExactStep& drive, LaneState s, int steps, Tick step, const Inputs& inputs) {
  for (int n = 0; n < steps; ++n) {
    const auto [command, F] = inputs(static_cast<double>(n * step) * kTick);
    drive.advance(s, command, F, step);
  }
  EXPECT_EQ(s.control.unresolved, 0U);
  return s;
}

Inputs constant(double command, double F = 0.0) {
  return [=](double) { return std::array{command, F}; };
}

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
  s = run(drive, s, 1000, kStep, constant(0.0));
  EXPECT_EQ(s.x, stopped.x);
  EXPECT_EQ(s.v, 0.0);
}

TEST(SetValued, DirectionsDecelerateWithTheirOwnForce) {
  constexpr double kStopTol = 1e-14;  // m
  FeedDriveParams p = bare_mass_with_coulomb();
  p.friction.Fc_negative = p.friction.Fs_negative = 150;
  const ExactStep drive(p, kTick, kStep);
  for (const double v : {0.05, -0.05}) {
    const LaneState s = run(drive, moving(p, v), 400, kStep, constant(0.0));
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
  const LaneState s = run(drive, moving(p, v), 250, kStep, constant(0.0, F));
  EXPECT_NEAR(s.x, v * v / (2 * a1) - 0.5 * a2 * (T - t1) * (T - t1), kPositionTol);
}

TEST(SetValued, BreaksAwayAtFsAndNotBefore) {
  for (const double side : {1.0, -1.0}) {
    FeedDriveParams p = bare_mass(FrictionKind::set_valued);
    p.friction.Fs_negative = 500;
    const ExactStep drive(p, kTick, kStep);
    const double Fs = side > 0 ? p.friction.Fs_positive : p.friction.Fs_negative;
    LaneState s = run(drive, {}, 1000, kStep, constant(0.0, -side * Fs));
    EXPECT_EQ(s.x, 0.0);
    EXPECT_EQ(s.slide, SlideMode::sticking);
    s = run(drive, s, 1, kStep, constant(0.0, -side * Fs * (1 + 1e-12)));
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
  s = run(drive, s, 2000, 100, constant(0.0, 0.8 * 560));
  const double settled = s.x;
  EXPECT_EQ(settled, 0.25);
  s = run(drive, s, 1000000, 100, constant(0.0, 0.8 * 560));
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
  LaneState s = run(drive, {}, 10, kStep, constant(0.99 * 450 / p.Kt));
  EXPECT_EQ(s.x, 0.0);
  s = run(drive, s, 50, kStep, constant(2.0 * 450 / p.Kt));
  EXPECT_EQ(s.i, 450.0);
  EXPECT_NEAR(s.x, 0.5 * 450 / p.slide_mass() * 1e-4, kPositionTol);  // after 10 ms
}

// --- LuGre and regularised friction -------------------------------------------------------------

TEST(LuGre, HoldsWithinItsPresliding) {
  // dz/dx = 1 - sigma0 z / Fs: the slide has moved by (Fs / sigma0) ln(1 / (1 - F / Fs))
  constexpr double kPreslidingTol = 1e-9;  // m, speed and inertia of the ramp
  constexpr double kForceTol = 1e-6;       // N
  constexpr double kCreepTol = 1e-15;      // m in 100 s
  const FeedDriveParams p = bare_mass(FrictionKind::lugre);
  const double F = 0.8 * 560;
  const ExactStep drive(p, kTick, 100);
  const auto slow_ramp = [&](double t) {
    return std::array{0.0, -F * 0.5 * (1 - std::cos(0.1 * std::numbers::pi * std::min(t, 10.0)))};
  };
  LaneState s = run(drive, {}, 20000, 100, slow_ramp);
  EXPECT_NEAR(p.friction.sigma0 * s.z, F, kForceTol);
  EXPECT_NEAR(s.x, 560 / p.friction.sigma0 * std::log(5.0), kPreslidingTol);
  const double settled = s.x;
  s = run(drive, s, 100000, 100, constant(0.0, -F));
  EXPECT_NEAR(s.x, settled, kCreepTol);
}

TEST(LuGre, IsStableAndExactInItsSteadyForceAtRapidSpeed) {
  // sigma0 |v| h / g = 15: an explicit step of 200 us would explode
  constexpr double kForceTol = 1e-6;  // N
  const FeedDriveParams p = bare_mass(FrictionKind::lugre);
  const double h = kStep * kTick;
  const Resolution whole_steps{.tolerance = std::numeric_limits<double>::infinity(), .longest = h};
  for (const Resolution& resolution : {Resolution{}, whole_steps}) {
    const ExactStep drive(p, h, 1, resolution);
    LaneState s = moving(p, 0.67);  // bristles straight
    for (int n = 0; n < 50; ++n) drive.advance(s, 0.0, 0.0, 1);
    EXPECT_NEAR(bristle_force(p.friction, s.v, s.z), 450, kForceTol);
  }
}

TEST(Regularised, CreepsUnderLoadAtTheSpeedWhereItsForceBalances) {
  constexpr double kRelativeTol = 1e-6;  // g(v) instead of Fs: (v / vs)^2
  FeedDriveParams p = bare_mass(FrictionKind::regularised);
  p.friction.v0 = 1e-5;
  p.friction.vs = 0.1;
  const ExactStep drive(p, kTick, kStep);
  const LaneState s = run(drive, {}, 500, kStep, constant(0.0, -0.8 * 560));
  const double expected = p.friction.v0 * std::atanh(0.8);
  EXPECT_NEAR(s.v, expected, kRelativeTol * expected);
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
    const auto push = constant(1.0);
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
  p.J = 1e12;  // turns as told
  const ExactStep drive(p, kTick, 100);
  LaneState s = at_rest(p, 0.0);
  s.w = 1e-3 / p.r;
  s = run(drive, s, 2000, 100, constant(0.0));
  const double phi_there = (s.delta + s.x) / p.r;
  const double x_there = s.x;
  s.w = -s.w;
  s = run(drive, s, 2000, 100, constant(0.0));
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
  LaneState s = run(drive, {.x = rest}, 100, kStep, constant(0.0));
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

// --- against an independent integration
// -----------------------------------------------------------

// Classical Runge-Kutta in long double of the equations as feed_drive.h states them.
class RungeKutta {
 public:
  explicit RungeKutta(const FeedDriveParams& p) : p_(p) {}
  void hold(long double command, long double F, double duration, double step) {
    const int n = static_cast<int>(std::ceil(duration / step));
    const long double h = static_cast<long double>(duration) / n;
    for (int k = 0; k < n; ++k) {
      const State a = rate(y_, command, F), b = rate(plus(y_, a, h / 2), command, F);
      const State c = rate(plus(y_, b, h / 2), command, F), d = rate(plus(y_, c, h), command, F);
      for (std::size_t i = 0; i < y_.size(); ++i) {
        y_[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
      }
    }
  }
  double x() const { return static_cast<double>(y_[4]); }

 private:
  using State = std::array<long double, 6>;  // i, w, delta, v, x, z
  static State plus(State y, const State& dy, long double h) {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h * dy[i];
    return y;
  }
  State rate(const State& y, long double command, long double F) const {
    const auto [i, w, delta, v, x, z] = y;
    const FrictionParams& f = p_.friction;
    const long double q = v / f.vs;
    const long double g = f.Fc_positive + (f.Fs_positive - f.Fc_positive) * std::exp(-q * q);
    long double dz = 0, friction = 0;
    if (f.kind == FrictionKind::lugre) {
      dz = v - f.sigma0 * std::abs(v) * z / g;
      friction = f.sigma0 * z + f.sigma1 * dz;
    } else {
      friction = g * std::tanh(v / f.v0);
    }
    const long double ddelta = p_.r * w - v;
    const long double S = p_.k * delta + p_.c * ddelta;
    return {(command - i) / p_.T_i,
            (p_.Kt * i - p_.r * S - p_.b_motor * w) / p_.J,
            ddelta,
            (S - p_.b_load * v - friction - F) / p_.M,
            v,
            dz};
  }
  FeedDriveParams p_;
  State y_{};
};

// Small moves to and fro with standstill between them: the whole of the friction curve.
double wiggle(double t) { return 2.2 * std::sin(60 * t) * (std::fmod(t, 0.2) < 0.14 ? 1.0 : 0.1); }

double worst_against_runge_kutta(const FeedDriveParams& p, double fine, int steps) {
  const ExactStep drive(p, kTick, kStep);
  RungeKutta reference(p);
  LaneState s;
  double worst = 0.0;
  for (int n = 0; n < steps; ++n) {
    const double command = wiggle(n * kStep * kTick);
    drive.advance(s, command, 30.0, kStep);
    reference.hold(command, 30.0, kStep * kTick, fine);
    worst = std::max(worst, std::abs(s.x - reference.x()));
  }
  EXPECT_EQ(s.control.unresolved, 0U);
  EXPECT_GT(std::abs(s.x), 1e-6);
  ::testing::Test::RecordProperty("worst_pm", std::to_string(worst * 1e12));
  return worst;
}

// m after 0.1 s: what the sub-steps miss adds up, for no servo loop takes it back
constexpr double kOpenLoopTol = 0.01 * kNanometre;

TEST(Regularised, AgreesWithRungeKutta) {
  FeedDriveParams p = x_axis_with(FrictionKind::regularised);
  EXPECT_LT(worst_against_runge_kutta(p, 2e-6, 500), kOpenLoopTol);
}

TEST(Regularised, AgreesWithRungeKuttaWhenSharp) {
  FeedDriveParams p = x_axis_with(FrictionKind::regularised);
  p.friction.v0 = 1e-5;
  EXPECT_LT(worst_against_runge_kutta(p, 1e-6, 500), kOpenLoopTol);
}

TEST(LuGre, AgreesWithRungeKutta) {
  FeedDriveParams p = x_axis_with(FrictionKind::lugre);
  EXPECT_LT(worst_against_runge_kutta(p, 2e-6, 500), kOpenLoopTol);
}

// --- order of convergence ----------------------------------------------------------------------

// Root mean square over some starts of the error of x after 0.1 s, with sub-steps of fixed length.
double error_of_fixed_steps(const FeedDriveParams& p, const LaneState& start, const Inputs& inputs,
                            double length) {
  constexpr int kStarts = 5;
  double sum = 0.0;
  for (int phase = 0; phase < kStarts; ++phase) {
    const auto end = [&](const Resolution& resolution) {
      const ExactStep drive(p, kTick, 64, resolution);
      LaneState s = start;
      for (int n = 0; n < 160; ++n) {
        const auto [command, F] = inputs(n * 64 * kTick + 0.01 * phase);
        drive.advance(s, command, F, 64);
      }
      return s.x;
    };
    const double fixed =
        end({.tolerance = std::numeric_limits<double>::infinity(), .longest = length});
    sum += std::pow(fixed - end({.tolerance = 1e-16}), 2);
  }
  return std::sqrt(sum / kStarts);
}

double order(const FeedDriveParams& p, const LaneState& start, const Inputs& inputs) {
  const double coarse = error_of_fixed_steps(p, start, inputs, 320e-6);
  const double fine = error_of_fixed_steps(p, start, inputs, 160e-6);
  ::testing::Test::RecordProperty("coarse_pm", std::to_string(coarse * 1e12));
  ::testing::Test::RecordProperty("fine_pm", std::to_string(fine * 1e12));
  return std::log2(coarse / fine);
}

TEST(Order, IsFourWhereTheForceIsSmooth) {
  FeedDriveParams p = x_axis_with(FrictionKind::set_valued);
  LaneState s;
  s.v = 2e-3;
  s.w = s.v / p.r;
  s.delta = 500 / p.k;
  const auto push = [](double t) { return std::array{1.2, -40 * std::sin(300 * t)}; };
  EXPECT_GT(order(p, s, push), 3.7);
}

TEST(Order, IsFourThroughReversalsAndStick) {
  const auto inputs = [](double t) { return std::array{wiggle(t), 30.0}; };
  EXPECT_GT(order(x_axis_with(FrictionKind::set_valued), {}, inputs), 3.5);
  EXPECT_GT(order(x_axis_with(FrictionKind::lugre), {}, inputs), 3.5);
}

// --- every drive
// ----------------------------------------------------------------------------------

FeedDriveParams random_drive(std::mt19937& random) {
  const auto between = [&](double low, double high) {
    return low * std::pow(high / low, std::ldexp(static_cast<double>(random()), -32));
  };
  FeedDriveParams p = x_axis();
  p.kind = random() % 3 ? DriveKind::two_mass : DriveKind::rigid;
  p.J *= between(0.1, 10);
  p.M *= between(0.1, 10);
  p.k *= between(0.1, 10);
  p.c *= between(0.01, 3);
  p.b_load *= between(0.01, 1);
  p.gap = p.kind == DriveKind::two_mass && random() % 2 ? between(1e-6, 1e-4) : 0.0;
  p.friction.kind = static_cast<FrictionKind>(random() % 4);
  FrictionParams& f = p.friction;
  f.Fc_positive = between(30, 1000);
  f.Fc_negative = between(30, 1000);
  f.Fs_positive = f.Fc_positive * between(1, 2);
  f.Fs_negative = f.Fc_negative * between(1, 2);
  f.vs = between(1e-4, 1e-2);
  f.v0 = between(1e-6, 1e-3);
  f.sigma0 = between(1e7, 1e9);
  f.sigma1 = between(1e3, 3e4);
  return p;
}

double energy(const FeedDriveParams& p, const LaneState& s) {
  double spring = 0.0;
  if (!p.is_rigid() && s.contact != ContactMode::gap) {
    const double d = s.delta - contact_offset(p, s.contact);
    spring = 0.5 * p.k * d * d;
  }
  const double bristles =
      p.friction.kind == FrictionKind::lugre ? 0.5 * p.friction.sigma0 * s.z * s.z : 0.0;
  const double motor = p.is_rigid() ? 0.0 : 0.5 * p.J * s.w * s.w;
  return motor + 0.5 * p.slide_mass() * s.v * s.v + spring + bristles;
}

TEST(EveryDrive, NeverGainsEnergyByItself) {
  constexpr double kRoundingTol = 1e-12;  // of the energy at the start
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const FeedDriveParams p = random_drive(random);
    ASSERT_TRUE(implausible(p).empty());
    ASSERT_TRUE(unrepresentable(p, kTick).empty()) << seed << unrepresentable(p, kTick)[0];
    const ExactStep drive(p, kTick, kStep);
    LaneState s;
    s.v = std::ldexp(static_cast<double>(random()), -32) * 0.02 - 0.01;
    s.w = s.v / p.r;
    const double start = energy(p, s);
    double before = start;
    for (int n = 0; n < 500; ++n) {
      drive.advance(s, 0.0, 0.0, kStep);
      const double now = energy(p, s);
      ASSERT_LE(now, before + kRoundingTol * start) << "seed " << seed << " step " << n;
      before = now;
    }
    EXPECT_EQ(s.control.unresolved, 0U) << seed;
  }
}

TEST(EveryDrive, ALongStepIsManyShortOnes) {
  constexpr double kLengthTol = 0.1 * kNanometre;  // after 0.06 s without a servo loop
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    const FeedDriveParams p = random_drive(random);
    const ExactStep drive(p, kTick, 60);
    LaneState coarse = at_rest(p, 0.0), fine = coarse;
    for (int n = 0; n < 100; ++n) {
      const double command = wiggle(n * 60 * kTick);
      drive.advance(coarse, command, 0.0, 60);
      for (int k = 0; k < 12; ++k) drive.advance(fine, command, 0.0, 5);
      ASSERT_NEAR(coarse.x, fine.x, kLengthTol) << "seed " << seed << " step " << n;
    }
  }
}

TEST(EveryDrive, ASubStepThatMissesItsToleranceIsCounted) {
  const FeedDriveParams p = x_axis_with(FrictionKind::regularised);
  for (const double tolerance : {2e-12, 1e-40}) {
    const ExactStep drive(p, kTick, 1, {.tolerance = tolerance});
    LaneState s;
    drive.advance(s, 10.0, 0.0, 1);
    EXPECT_EQ(s.control.unresolved > 0, tolerance < 1e-30);
  }
}

TEST(EveryDrive, WhatCannotBeRepresentedIsRefusedWithTheRate) {
  FeedDriveParams p = x_axis_with(FrictionKind::regularised);
  EXPECT_TRUE(unrepresentable(p, kTick).empty());
  p.friction.v0 = 1e-9;
  EXPECT_EQ(unrepresentable(p, kTick),
            std::vector<std::string>{
                "the slope of the regularised friction, breakaway / "
                "(regularisation_velocity mass), makes a rate of 7.47e+08 1/s; the exact step "
                "resolves up to 1e+08 1/s"});
  p = x_axis_with(FrictionKind::set_valued);
  p.k = 1e20;
  EXPECT_EQ(unrepresentable(p, kTick).size(), 1U);
}

}  // namespace
}  // namespace servomill::plant::exact_step_test
