#include "plant/drives/exact_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "plant/drives/drive_rates.h"
#include "tests/plant/drives/single_drive.h"

namespace servomill::plant::exact_step_test {
namespace {

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
  s = run(drive, s, 100000, 100, constant_inputs(0.0, -F));
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
  const LaneState s = run(drive, {}, 500, kStep, constant_inputs(0.0, -0.8 * 560));
  const double expected = p.friction.v0 * std::atanh(0.8);
  EXPECT_NEAR(s.v, expected, kRelativeTol * expected);
}

// --- against an independent integration --------------------------------------------------------

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

// --- every drive -------------------------------------------------------------------------------

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

}  // namespace
}  // namespace servomill::plant::exact_step_test
