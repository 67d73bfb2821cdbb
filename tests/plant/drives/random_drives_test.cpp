/// The exact step against CVODE on drives and commands at random. SERVOMILL_RANDOM_DRIVES sets how
/// many; a failure names the number from which its drive follows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "plant/drives/cvode_drive.h"
#include "plant/drives/drive_rates.h"
#include "plant/drives/exact_step.h"
#include "tests/plant/drives/random_drive.h"

namespace servomill::plant::random_drives_test {
namespace {

constexpr double kAgreementTol = 0.1;  // nm after 60 ms, from the tolerance of the exact step
constexpr double kTick = 10e-6;
constexpr Tick kHold = 20;
constexpr int kHolds = 300;

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
}  // namespace servomill::plant::random_drives_test
