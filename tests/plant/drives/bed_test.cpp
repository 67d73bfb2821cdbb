/// A drive on a bed that its reaction pushes back: momentum, energy, closed forms, both
/// integrators.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "plant/drives/cvode_drive.h"
#include "plant/drives/drive_bank.h"
#include "plant/drives/drive_rates.h"
#include "plant/drives/exact_step.h"
#include "tests/plant/drives/drives.h"
#include "tests/plant/drives/random_drive.h"

namespace servomill::plant::bed_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Tick kHold = 20;

FeedDriveParams on_bed(FeedDriveParams p, double M = 6000.0, double f = 18.0, double zeta = 0.04) {
  p.bed = {M, 2.0 * kPi * f, zeta};
  return p;
}

FeedDriveParams without_losses(FeedDriveParams p) {
  p.c = p.b_motor = p.b_load = p.bed.zeta = 0.0;
  return p;
}

FeedDriveParams rigid(FeedDriveParams p) {
  p.kind = DriveKind::rigid;
  return p;
}

// Linear motor: slide and primary part move together.
FeedDriveParams linear_motor() {
  FeedDriveParams p = x_axis();
  p.kind = DriveKind::direct;
  p.r = 1.0;
  p.J = 60.0;
  p.Kt = 90.0;
  return p;
}

std::vector<FeedDriveParams> kinds() { return {x_axis(), rigid(x_axis()), linear_motor()}; }

double command_at(const FeedDriveParams& p, int n) {
  return 0.2 * p.travelling_mass() * p.r / p.Kt * std::sin(0.09 * n) * std::cos(0.0113 * n);
}

LaneState pushed(const FeedDriveParams& p, int holds) {
  const ExactStep drive(p, kTick, kHold);
  LaneState s;
  for (int n = 0; n < holds; ++n) drive.advance(s, command_at(p, n), 0.0, kHold);
  return s;
}

// m (v + b') of the slide and what the bed has: without mounts nothing from outside acts.
TEST(Bed, momentum_of_slide_and_free_bed_is_conserved) {
  for (const FeedDriveParams& fixed : kinds()) {
    const FeedDriveParams p = on_bed(fixed, 6000.0, 0.0, 0.0);
    const double m = p.travelling_mass();
    const ExactStep drive(p, kTick, kHold);
    LaneState s;
    double most = 0.0, off = 0.0, centre = 0.0;  // N s, N s, kg m
    for (int n = 0; n < 2000; ++n) {
      drive.advance(s, command_at(p, n), 0.0, kHold);
      most = std::max(most, m * std::abs(s.v));
      off = std::max(off, std::abs(m * (s.v + s.bed_v) + p.bed.M * s.bed_v));
      centre = std::max(centre, std::abs(m * (s.x + s.bed_x) + p.bed.M * s.bed_x));
    }
    EXPECT_GT(most, 0.1);
    EXPECT_LE(off, 1e-9 * most);
    EXPECT_LE(centre, 1e-9 * m * std::abs(s.x));  // their centre of gravity stays
  }
}

// Impulse of the mounts: integral of -(M + M_bed)(2 zeta w b' + w^2 b) is what momentum has gained.
TEST(Bed, momentum_is_what_the_mounts_have_given) {
  for (const FeedDriveParams& fixed : kinds()) {
    const FeedDriveParams p = on_bed(fixed);
    const ExactStep drive(p, kTick, 1);
    LaneState s;
    double impulse = 0.0;  // N s, by Simpson's rule over two ticks
    const double all = p.travelling_mass() + p.bed.M;
    const auto of_mounts = [&](const LaneState& at) {
      return -all * (2.0 * p.bed.zeta * p.bed.w * at.bed_v + p.bed.w * p.bed.w * at.bed_x);
    };
    double most = 0.0;
    for (int n = 0; n < 20000; ++n) {
      double f[3] = {of_mounts(s), 0.0, 0.0};
      for (int k = 1; k < 3; ++k) {
        drive.advance(s, command_at(p, n / 10), 0.0, 1);
        f[k] = of_mounts(s);
      }
      impulse += 2.0 * kTick / 6.0 * (f[0] + 4.0 * f[1] + f[2]);
      most = std::max(most, std::abs(impulse));
    }
    const double momentum = p.travelling_mass() * (s.v + s.bed_v) + p.bed.M * s.bed_v;
    EXPECT_LE(std::abs(momentum - impulse), 1e-9 * most);
  }
}

// Kinetic and elastic energy of motor, slide, bed, screw and mounts (J).
double energy(const FeedDriveParams& p, const LaneState& s) {
  const double m = p.travelling_mass(), turning = p.kind == DriveKind::direct ? 0.0 : p.J;
  const double screw = p.is_rigid() ? 0.0 : 0.5 * p.k * s.delta * s.delta;
  const double w = p.is_rigid() ? s.v / p.r : s.w;
  return 0.5 * turning * w * w + 0.5 * m * (s.v + s.bed_v) * (s.v + s.bed_v) +
         0.5 * p.bed.M * s.bed_v * s.bed_v + screw +
         0.5 * (m + p.bed.M) * p.bed.w * p.bed.w * s.bed_x * s.bed_x;
}

// Power that dampers take (W).
double losses(const FeedDriveParams& p, const LaneState& s) {
  const double w = p.is_rigid() ? s.v / p.r : s.w, rate = p.r * w - s.v;
  return p.b_motor * w * w + p.b_load * s.v * s.v + (p.is_rigid() ? 0.0 : p.c * rate * rate) +
         2.0 * p.bed.zeta * p.bed.w * (p.travelling_mass() + p.bed.M) * s.bed_v * s.bed_v;
}

// |work of the motor - stored - dissipated| <= 1e-9 of the work. Integrals by Gauss and Lobatto
// over four ticks with five points, which the states at every tick are.
TEST(Bed, work_of_the_motor_is_stored_or_dissipated) {
  for (const FeedDriveParams& fixed : kinds()) {
    const FeedDriveParams p = on_bed(fixed);
    const ExactStep drive(p, kTick, 1);
    LaneState s;
    double work = 0.0, dissipated = 0.0, turnover = 0.0;
    constexpr double kBoole[5] = {7.0 / 90, 32.0 / 90, 12.0 / 90, 32.0 / 90, 7.0 / 90};
    for (int n = 0; n < 20000; ++n) {
      for (int k = 0; k < 5; ++k) {
        const double w = p.is_rigid() ? s.v / p.r : s.w;
        const double power = p.Kt * s.i * w;
        work += 4.0 * kTick * kBoole[k] * power;
        turnover += 4.0 * kTick * kBoole[k] * std::abs(power);
        dissipated += 4.0 * kTick * kBoole[k] * losses(p, s);
        if (k < 4) drive.advance(s, command_at(p, n / 5), 0.0, 1);
      }
    }
    EXPECT_GT(dissipated, 1e-3 * turnover);
    EXPECT_LE(std::abs(work - energy(p, s) - dissipated), 1e-9 * turnover);
  }
}

TEST(Bed, energy_without_losses_is_conserved) {
  for (const FeedDriveParams& fixed : kinds()) {
    const FeedDriveParams p = without_losses(on_bed(fixed));
    LaneState s = pushed(p, 500);
    s.i = 0.0;
    const ExactStep drive(p, kTick, kHold);
    const double begin = energy(p, s);
    for (int n = 0; n < 20000; ++n) drive.advance(s, 0.0, 0.0, kHold);  // 4 s
    EXPECT_LE(std::abs(energy(p, s) / begin - 1.0), 1e-9);
  }
}

// Largest difference to a bed that stands still, over a run (m).
double away(const FeedDriveParams& fixed, const FeedDriveParams& p) {
  const ExactStep drive(p, kTick, kHold), without(fixed, kTick, kHold);
  LaneState s, t;
  double most = 0.0;
  for (int n = 0; n < 500; ++n) {
    drive.advance(s, command_at(p, n), 0.0, kHold);
    without.advance(t, command_at(p, n), 0.0, kHold);
    most = std::max(most, std::abs(s.x - t.x));
  }
  return most;
}

// It yields by M x'' / ((M + M_bed) w^2).
TEST(Bed, that_swings_fast_or_is_heavy_stands_still) {
  for (const FeedDriveParams& fixed : kinds()) {
    const double slow = away(fixed, on_bed(fixed, 6000.0, 1000.0, 0.5));
    const double fast = away(fixed, on_bed(fixed, 6000.0, 4000.0, 0.5));
    EXPECT_LE(slow, 1e-8);
    EXPECT_NEAR(slow / fast, 16.0, 1.0);
    const double light = away(fixed, on_bed(fixed, 1e8)), heavy = away(fixed, on_bed(fixed, 1e10));
    EXPECT_NEAR(light / heavy, 100.0, 1.0);
  }
}

// From the force on the slide to its position on the bed (struct FeedDriveParams).
std::complex<double> compliance(const FeedDriveParams& p, std::complex<double> s) {
  const double m = p.travelling_mass(), mu = m * p.bed.M / (m + p.bed.M);
  const auto mounts = 2.0 * p.bed.zeta * p.bed.w * s + p.bed.w * p.bed.w;
  return (s * s + mounts) / (mu * s * s * (s * s + (m + p.bed.M) / p.bed.M * mounts));
}

std::complex<double> response(const FeedDriveParams& p, std::complex<double> s) {
  const DriveEquations<7> all = drive_equations_on_bed(p);
  const Eigen::Matrix<std::complex<double>, 7, 7> A =
      s * Eigen::Matrix<std::complex<double>, 7, 7>::Identity() -
      all.leftCols<7>().cast<std::complex<double>>();
  return A.fullPivLu().solve(all.col(8).cast<std::complex<double>>().eval())[6];
}

// Two masses: a zero at the frequency of the bed, a pole above it.
TEST(Bed, response_to_a_force_is_that_of_two_masses) {
  FeedDriveParams p = on_bed(linear_motor());
  p.b_motor = p.b_load = 0.0;
  for (double f = 1.0; f < 300.0; f *= 1.07) {
    const std::complex<double> s(0.0, 2.0 * kPi * f);
    EXPECT_LE(std::abs(response(p, s) / -compliance(p, s) - 1.0), 1e-9) << f;
  }
  p = without_losses(p);
  const auto at = [&](double f) {
    return std::abs(response(p, {0.0, 2.0 * kPi * f})) * std::pow(2.0 * kPi * f, 2.0);
  };
  EXPECT_LE(at(18.0) * p.travelling_mass(), 1e-9);
  const double pole = 18.0 * std::sqrt((p.travelling_mass() + p.bed.M) / p.bed.M);
  EXPECT_GE(at(pole * (1.0 + 1e-9)) * p.travelling_mass(), 1e6);
}

// A held slide: the bed swings as given, with it.
TEST(Bed, swings_with_a_sticking_slide_at_its_own_frequency) {
  FeedDriveParams p = on_bed(rigid(x_axis_with(FrictionKind::set_valued)));
  const ExactStep drive(p, kTick, kHold);
  LaneState s;
  s.bed_x = 1e-6;
  const double w_d = p.bed.w * std::sqrt(1.0 - p.bed.zeta * p.bed.zeta), a = p.bed.zeta * p.bed.w;
  for (int n = 1; n <= 1000; ++n) {
    drive.advance(s, 0.0, 0.0, kHold);
    const double t = n * kHold * kTick;
    const double closed =
        1e-6 * std::exp(-a * t) * (std::cos(w_d * t) + a / w_d * std::sin(w_d * t));
    ASSERT_NEAR(s.bed_x, closed, 1e-18);
    ASSERT_EQ(s.x, 0.0);
  }
}

// The force of a bed that is off breaks a slide away beyond Fs, and not below.
TEST(Bed, breaks_a_slide_away_beyond_its_friction) {
  const FeedDriveParams p = on_bed(rigid(x_axis_with(FrictionKind::set_valued)));
  const double limit = p.friction.Fs_positive / (p.travelling_mass() * p.bed.w * p.bed.w);  // m
  for (const double share : {0.99, 1.01}) {
    const ExactStep drive(p, kTick, kHold);
    LaneState s;
    s.bed_x = share * limit;
    drive.advance(s, 0.0, 0.0, kHold);
    EXPECT_EQ(s.x > 0.0, share > 1.0);
  }
}

// Both integrators through stick, slip, reversal and backlash.
TEST(Bed, integrators_agree_for_drives_at_random) {
  constexpr double kAgreementTol = 0.1e-9;  // m, as without a bed
  Dice dice(20250511);
  int moved = 0;
  for (int drives = 0; drives < 60; ++drives) {
    FeedDriveParams p = random_drive(dice);
    p.cogging = {};
    if (p.kind == DriveKind::direct) continue;  // of a rotary axis
    p.bed = {dice.of_size(500.0, 20000.0), 2.0 * kPi * dice.of_size(5.0, 80.0),
             dice.one_in(4) ? 0.0 : dice.of_size(0.005, 0.3)};
    if (!implausible(p).empty() || !unrepresentable(p, kTick).empty()) continue;
    const ExactStep exact(p, kTick, kHold);
    CvodeDrive cvode(p);
    LaneState a = at_rest(p, 0.1), b = a;
    const double scale = (p.has_winding() ? p.R : 1.0) * p.r / p.Kt * 3.0 * p.friction.Fs_positive;
    for (int n = 0; n < 400; ++n) {
      const double u = (p.has_winding() ? p.R * a.i * 0.0 : 0.0) + scale * std::sin(0.05 * n);
      exact.advance(a, u, 0.0, kHold);
      cvode.advance(b, u, 0.0, kHold * kTick);
      ASSERT_NEAR(a.x, b.x, kAgreementTol) << drives << " " << n;
      ASSERT_NEAR(a.bed_x, b.bed_x, kAgreementTol) << drives << " " << n;
    }
    moved += std::abs(a.bed_x) > 1e-9;
  }
  EXPECT_GE(moved, 10);
}

// Neighbours in the lanes of a bank, and a bank's lane against the drive alone: bit for bit.
TEST(Bed, lanes_are_the_drive_alone_and_leave_others_as_they_are) {
  std::vector<FeedDriveParams> lanes(8, x_axis_with(FrictionKind::lugre));
  lanes[3] = on_bed(x_axis_with(FrictionKind::lugre));
  lanes[5] = on_bed(x_axis());
  std::vector<FeedDriveParams> others = lanes;
  others[3].bed = others[5].bed = {};
  const DriveBank bank(lanes, kTick, std::array{kHold}), fixed(others, kTick, std::array{kHold});
  const std::vector<double> x(8, 0.1);
  DriveState s = bank.at_rest(x), t = fixed.at_rest(x);
  DriveInput input(8);
  const ExactStep alone(lanes[3], kTick, kHold);
  LaneState one = at_rest(lanes[3], 0.1);
  for (int n = 0; n < 500; ++n) {
    input.blocks[0].command = all_lanes(12.0 * std::sin(0.05 * n));
    bank.advance(s, input, kHold);
    fixed.advance(t, input, kHold);
    alone.advance(one, input.blocks[0].command[3], 0.0, kHold);
  }
  for (std::size_t l = 0; l < 8; ++l) {
    const LaneState a = s.lane(l), b = t.lane(l);
    if (l == 3 || l == 5) {
      EXPECT_NE(a.x, b.x);
      EXPECT_NE(a.bed_x, 0.0);
    } else {
      EXPECT_EQ(a.x, b.x);
      EXPECT_EQ(a.bed_x, 0.0);
    }
  }
  EXPECT_EQ(s.lane(3).x, one.x);
  EXPECT_EQ(s.lane(3).bed_x, one.bed_x);
}

TEST(Bed, must_be_possible) {
  FeedDriveParams p = x_axis();
  p.bed = {-1.0, -1.0, 1.0};
  EXPECT_EQ(implausible(p), (std::vector<std::string>{"bed.M must be >= 0", "bed.w must be >= 0",
                                                      "bed.zeta must be >= 0 and < 1"}));
}

}  // namespace
}  // namespace servomill::plant::bed_test
