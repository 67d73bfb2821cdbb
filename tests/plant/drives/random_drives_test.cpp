/// The exact step against CVODE on drives and commands at random. SERVOMILL_RANDOM_DRIVES sets how
/// many; a failure names the number from which its drive follows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>

#include "plant/drives/cvode_drive.h"
#include "plant/drives/exact_step.h"

namespace servomill::plant {
namespace {

constexpr double kAgreementTol = 0.1;  // nm after 60 ms, from the tolerance of the exact step
constexpr double kTick = 10e-6;
constexpr Tick kHold = 20;
constexpr int kHolds = 300;

class Dice {
 public:
  explicit Dice(unsigned seed) : bits_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(bits_()), -32);
  }
  double of_size(double low, double high) { return low * std::pow(high / low, between(0.0, 1.0)); }
  bool one_in(double n) { return between(0.0, n) < 1.0; }

 private:
  std::mt19937 bits_;
};

// About an axis of a milling machine; `small` scales forces and masses to a rotary axis.
FeedDriveParams random_drive(Dice& dice) {
  FeedDriveParams p;
  p.kind = dice.one_in(2)   ? DriveKind::two_mass
           : dice.one_in(2) ? DriveKind::rigid
                            : DriveKind::direct;
  const bool rotary = p.kind == DriveKind::direct;
  const double small = rotary ? 0.01 : 1.0;
  p.r = rotary ? 1.0 : 0.02 / (2.0 * std::numbers::pi);
  p.J = rotary ? dice.of_size(0.5, 20.0) : dice.of_size(3e-3, 3e-2);
  p.M = small * dice.of_size(100.0, 2000.0);
  p.k = dice.of_size(3e7, 6e8);
  if (!dice.one_in(5)) p.c = dice.of_size(1e3, 1e5);
  if (!dice.one_in(3)) p.b_motor = dice.of_size(0.003, 0.03);
  if (!dice.one_in(3)) p.b_load = small * dice.of_size(100.0, 5000.0);
  if (p.kind == DriveKind::two_mass && dice.one_in(3)) p.gap = dice.of_size(1e-7, 1e-4);
  p.Kt = rotary ? 10.0 : 1.6;
  if (dice.one_in(3)) {
    p.L = dice.of_size(2e-3, 1e-2);
    p.R = dice.of_size(0.3, 2.0);
    p.Ke = dice.of_size(0.3, 1.0);
  } else if (dice.one_in(2)) {
    p.T_i = dice.of_size(1e-4, 1e-3);
  }
  if (dice.one_in(3)) p.F_load = small * dice.between(-200.0, 200.0);

  const double Fc = small * dice.of_size(100.0, 600.0);
  FrictionParams& f = p.friction;
  f.kind = static_cast<FrictionKind>(static_cast<int>(dice.between(0.0, 4.0)));
  f.Fc_positive = Fc;
  f.Fc_negative = Fc * dice.between(0.7, 1.3);
  f.Fs_positive = f.Fc_positive * dice.between(1.0, 1.6);
  f.Fs_negative = f.Fc_negative * dice.between(1.0, 1.6);
  f.vs = dice.of_size(5e-4, 2e-2);
  f.v0 = dice.of_size(1e-5, 1e-3);
  f.sigma0 = small * dice.of_size(1e7, 2e8);
  if (!dice.one_in(5)) f.sigma1 = small * dice.of_size(1e3, 1e5);
  if (rotary && dice.one_in(2)) {
    p.cogging = {dice.between(0.0, Fc), std::floor(dice.between(10.0, 150.0)),
                 dice.between(0.0, 6.0)};
  }
  return p;
}

void expect_agreement(unsigned number) {
  Dice dice(number);
  const FeedDriveParams p = random_drive(dice);
  ASSERT_TRUE(implausible(p).empty()) << "drive " << number;
  ASSERT_TRUE(unrepresentable(p, kTick).empty()) << "drive " << number;
  const ExactStep exact(p, kTick, kHold);
  CvodeDrive cvode(p);
  LaneState a = at_rest(p, 0.1), b = a;
  const double force = 1.3 * p.friction.Fc_positive + std::abs(p.F_load);
  const double strength = force * p.r / p.Kt * (p.has_winding() ? p.R : 1.0);
  double command = 0.0, F = 0.0;
  for (int n = 0; n < kHolds; ++n) {
    if (n % 10 == 0) command = strength * dice.between(-2.0, 2.0) * (dice.one_in(3) ? 0.4 : 1.0);
    if (n % 37 == 0) F = p.friction.Fc_positive * dice.between(-1.0, 1.0);
    exact.advance(a, command, F, kHold);
    cvode.advance(b, command, F, static_cast<double>(kHold) * kTick);
    ASSERT_LE(1e9 * std::abs(a.x - b.x), kAgreementTol) << "drive " << number << ", hold " << n;
  }
  EXPECT_EQ(a.control.unresolved, 0u) << "drive " << number;
}

TEST(ExactStepAndCvode, AgreeOnDrivesAtRandom) {
  const char* text = std::getenv("SERVOMILL_RANDOM_DRIVES");
  const unsigned count = text == nullptr ? 20 : static_cast<unsigned>(std::stoul(text));
  for (unsigned number = 1; number <= count; ++number) expect_agreement(number);
}

}  // namespace
}  // namespace servomill::plant
