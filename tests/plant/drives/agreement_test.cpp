/// The exact propagator and CVODE integrate the same equations by different means: what they give
/// for one drive under held commands, through sticks, slips, reversals and contacts.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "plant/drives/cvode_drive.h"
#include "plant/drives/drive_bank.h"
#include "plant/drives/exact_step.h"
#include "tests/plant/drives/drives.h"

namespace servomill::plant::agreement_test {
namespace {

constexpr double kAgreementTol = 0.1;  // nm, what the default tolerance of the exact step leaves
constexpr int kHolds = 1500;           // held commands
constexpr Tick kHold = 40;             // ticks of each; 0.6 s in all

FeedDriveParams with_winding(FeedDriveParams p) {
  p.L = 4e-3;
  p.R = 0.6;
  p.Ke = 0.8;
  return p;
}

FeedDriveParams with_backlash(FeedDriveParams p) {
  p.gap = 5e-6;
  return p;
}

// One inertia; both directions differ and a load pulls.
FeedDriveParams rigid_with_load(FeedDriveParams p) {
  p.kind = DriveKind::rigid;
  p.F_load = 150.0;
  p.friction.Fc_negative = 350.0;
  return p;
}

FeedDriveParams without_lag(FeedDriveParams p) {
  p.T_i = 0.0;
  return p;
}

// Command that would just break the slide away (A or V).
double breakaway_command(const FeedDriveParams& p) {
  const double i = p.friction.Fs_positive * p.r / p.Kt;
  return p.has_winding() ? p.R * i : i;
}

// In units of the breakaway command: swings that reverse, swings that leave the slide stuck, and
// steps at random.
class Command {
 public:
  double at(int hold) {
    const double t = static_cast<double>(hold) / kHolds;
    if (t < 0.35) return 1.7 * std::sin(60.0 * t);
    if (t < 0.6) return 0.6 * std::sin(60.0 * t);
    if (hold % 25 == 0) random_ = 2.0 * (std::ldexp(static_cast<double>(bits_()), -31) - 1.0);
    return random_;
  }

 private:
  std::mt19937 bits_{20250307};
  double random_ = 0.0;
};

// Positions (m) at the end of each held command, by CVODE.
std::vector<double> reference(const FeedDriveParams& p, Tick hold) {
  CvodeDrive cvode(p);
  LaneState s = at_rest(p, 0.1);
  Command command;
  std::vector<double> x;
  for (int n = 0; n < kHolds; ++n) {
    const double u = breakaway_command(p) * command.at(n);
    cvode.advance(s, u, 0.0, static_cast<double>(hold) * kTick);
    x.push_back(s.x);
  }
  return x;
}

// Largest difference of the exact step (nm).
double difference(const FeedDriveParams& p, Tick hold, const std::vector<double>& x,
                  const Resolution& resolution = {}) {
  const ExactStep exact(p, kTick, hold, resolution);
  LaneState s = at_rest(p, 0.1);
  Command command;
  double largest = 0.0;
  for (int n = 0; n < kHolds; ++n) {
    exact.advance(s, breakaway_command(p) * command.at(n), 0.0, hold);
    largest = std::max(largest, 1e9 * std::abs(s.x - x[static_cast<std::size_t>(n)]));
  }
  EXPECT_EQ(s.control.unresolved, 0u);
  return largest;
}

// The same of a lane of a bank.
double difference_of_lane(const FeedDriveParams& p, Tick hold, const std::vector<double>& x) {
  const DriveBank bank(std::array{p}, kTick, std::array{hold});
  DriveState s = bank.at_rest(std::array{0.1});
  DriveInput input(1);
  Command command;
  double largest = 0.0;
  for (int n = 0; n < kHolds; ++n) {
    input.blocks[0].command[0] = breakaway_command(p) * command.at(n);
    bank.advance(s, input, hold);
    largest = std::max(largest, 1e9 * std::abs(s.blocks[0].x[0] - x[static_cast<std::size_t>(n)]));
  }
  EXPECT_EQ(DriveBank::unresolved(s, 0), 0u);
  return largest;
}

void expect_agreement(const std::string& name, const FeedDriveParams& p) {
  SCOPED_TRACE(name);
  const std::vector<double> x = reference(p, kHold);
  const double found = difference(p, kHold, x);
  testing::Test::RecordProperty("difference_nm_" + name, fmt::format("{:.2g}", found));
  EXPECT_LE(found, kAgreementTol);
  const double lane = difference_of_lane(p, kHold, x);
  testing::Test::RecordProperty("lane_nm_" + name, fmt::format("{:.2g}", lane));
  EXPECT_LE(lane, kAgreementTol);

  double travel = 0.0;  // m
  int still = 0;
  for (std::size_t n = 1; n < x.size(); ++n) {
    travel += std::abs(x[n] - x[n - 1]);
    if (x[n] == x[n - 1]) ++still;
  }
  EXPECT_GT(travel, 1e-4);
  EXPECT_GE(still, p.friction.kind == FrictionKind::set_valued ? kHolds / 10 : 0);
}

void expect_agreement_of_all(FrictionKind kind) {
  expect_agreement("two_mass", x_axis_with(kind));
  expect_agreement("winding", with_winding(x_axis_with(kind)));
  expect_agreement("backlash", with_backlash(x_axis_with(kind)));
  expect_agreement("rigid", rigid_with_load(x_axis_with(kind)));
  expect_agreement("rigid_without_lag", without_lag(rigid_with_load(x_axis_with(kind))));
}

TEST(ExactStepAndCvode, AgreeWithSetValuedFriction) {
  expect_agreement_of_all(FrictionKind::set_valued);
}

TEST(ExactStepAndCvode, AgreeWithLugreFriction) { expect_agreement_of_all(FrictionKind::lugre); }

TEST(ExactStepAndCvode, AgreeWithRegularisedFriction) {
  expect_agreement_of_all(FrictionKind::regularised);
}

// Through reversals, sticks and contacts, without error control: from the length of the sub-steps.
void expect_fourth_order(const FeedDriveParams& p) {
  constexpr Tick kLong = 64, kShort = 16;
  const std::vector<double> x = reference(p, kLong);
  const auto error = [&](Tick longest) {
    return difference(
        p, kLong, x,
        {std::numeric_limits<double>::infinity(), static_cast<double>(longest) * kTick});
  };
  const double order = std::log2(error(kLong) / error(kShort)) / std::log2(kLong / kShort);
  EXPECT_GT(order, 3.9);
}

TEST(ExactStepAndCvode, DifferByTheFourthPowerOfTheSubStep) {
  expect_fourth_order(x_axis_with(FrictionKind::set_valued));
  expect_fourth_order(with_backlash(x_axis_with(FrictionKind::set_valued)));
  expect_fourth_order(x_axis_with(FrictionKind::lugre));
}

}  // namespace
}  // namespace servomill::plant::agreement_test
