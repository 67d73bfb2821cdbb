#include "plant/drives/drive_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/drives/cvode_drive.h"
#include "tests/plant/drives/drives.h"

namespace servomill::plant::drive_bank_test {
namespace {

DriveBank bank_of(const FeedDriveParams& p, std::initializer_list<Tick> steps) {
  return DriveBank(std::array{p}, kTick, std::vector<Tick>(steps));
}

// One drive with its inputs.
struct One {
  DriveState state = DriveState(1);
  DriveInput input = DriveInput(1);
  double& command = input.blocks[0].command[0];
  double& F = input.blocks[0].F[0];
  const DriveBlock& at = state.blocks[0];
};

TEST(DriveBank, AgreesWithCvodeUnderHeldInputs) {
  constexpr double kPositionTol = 1e-12;  // m, CVODE at rtol 1e-12 after 50 changes of input
  const DriveBank bank = bank_of(x_axis(), {20});
  One s;
  CvodeDrive reference(x_axis());
  LaneState r;
  for (int n = 0; n < 50; ++n) {
    s.command = 20.0 * std::sin(0.7 * n);
    s.F = n % 2 ? 300.0 : -100.0;
    bank.advance(s.state, s.input, 20);
    reference.advance(r, s.command, s.F, 20 * kTick);
    ASSERT_NEAR(s.at.x[0], r.x, kPositionTol) << n;
    ASSERT_NEAR(s.at.v[0], r.v, 1e-9) << n;
    ASSERT_NEAR(s.at.w[0], r.w, 1e-7) << n;
  }
}

TEST(DriveBank, OneLongStepEqualsManyShortOnes) {
  constexpr double kRoundingTol = 1e-15;  // m, sixty products of rounding
  const DriveBank bank = bank_of(x_axis(), {1, 60});
  One fine, coarse;
  fine.command = coarse.command = 12.0;
  for (int n = 0; n < 60; ++n) bank.advance(fine.state, fine.input, 1);
  bank.advance(coarse.state, coarse.input, 60);
  EXPECT_NEAR(fine.at.x[0], coarse.at.x[0], kRoundingTol);
}

TEST(DriveBank, ConstantCurrentAcceleratesTheTotalInertia) {
  FeedDriveParams p = x_axis();
  p.b_motor = p.b_load = 0.0;
  const DriveBank bank = bank_of(p, {1000});
  One s;
  s.command = 10.0;
  for (int n = 0; n < 20; ++n) bank.advance(s.state, s.input, 1000);  // until the screw is wound up
  const double v0 = s.at.v[0];
  for (int n = 0; n < 20; ++n) bank.advance(s.state, s.input, 1000);
  const double acceleration = (s.at.v[0] - v0) / (20 * 1000 * kTick);
  EXPECT_NEAR(acceleration, p.Kt * 10.0 * p.r / p.J_total(), 1e-6 * acceleration);
}

TEST(DriveBank, ResonatesWhereTheTwoMassFormulaSays) {
  FeedDriveParams p = x_axis();
  p.b_motor = p.b_load = 0.0;
  p.c = 0.0;
  const DriveBank bank = bank_of(p, {1});
  One s;
  double& delta = s.state.blocks[0].delta[0];
  delta = 1e-6;  // wound up, then released
  int crossings = 0;
  double first = 0, last = 0, before = delta;
  for (int n = 1; n < 100000; ++n) {
    bank.advance(s.state, s.input, 1);
    if (before > 0 && delta <= 0) {
      const double t = (n - delta / (delta - before)) * kTick;
      (crossings++ ? last : first) = t;
    }
    before = delta;
  }
  const double f = (crossings - 1) / (last - first);
  const double expected = std::sqrt(p.k * (1 / p.M + p.r * p.r / p.J)) / (2 * std::numbers::pi);
  EXPECT_NEAR(f, expected, 1e-5 * expected);
  EXPECT_NEAR(expected, 115.0, 0.5);  // what the set is known for, Hz
}

TEST(DriveBank, RigidIsTheStiffLimit) {
  const auto deviation = [](double stiffness_factor) {
    FeedDriveParams stiff = x_axis();
    stiff.k *= stiffness_factor;
    stiff.c *= std::sqrt(stiffness_factor);
    FeedDriveParams rigid = x_axis();
    rigid.kind = DriveKind::rigid;
    One a, b;
    const DriveBank bank_a = bank_of(stiff, {100}), bank_b = bank_of(rigid, {100});
    a.command = b.command = 10.0;
    for (int n = 0; n < 200; ++n) {
      bank_a.advance(a.state, a.input, 100);
      bank_b.advance(b.state, b.input, 100);
    }
    return std::abs(a.at.x[0] - b.at.x[0]);
  };
  const double coarse = deviation(1.0), fine = deviation(100.0);
  EXPECT_NEAR(coarse / fine, 100.0, 5.0);  // first order in 1/k
}

TEST(DriveBank, StaysAtRestUnderItsConstantLoad) {
  FeedDriveParams p = x_axis();
  p.F_load = 200.0;
  const DriveBank bank = bank_of(p, {20});
  One s;
  s.state.set_lane(0, bank.at_rest(std::array{0.25}).lane(0));
  s.command = s.at.i[0];
  for (int n = 0; n < 5000; ++n) bank.advance(s.state, s.input, 20);
  EXPECT_NEAR(s.at.x[0], 0.25, 1e-12);
  EXPECT_EQ(s.at.x[1], 0.0);  // lanes that fill the block do not move
}

FeedDriveParams with_friction(FrictionKind kind) {
  FeedDriveParams p = x_axis();
  p.friction = {.kind = kind,
                .Fc_positive = 450,
                .Fc_negative = 400,
                .Fs_positive = 560,
                .Fs_negative = 500,
                .vs = 2e-3,
                .v0 = 1e-4,
                .sigma0 = 5e7,
                .sigma1 = 3e4};
  return p;
}

// Largest difference (m) between a drive at the stops of stretches and after steps of their
// lengths, to and fro through both zones of friction.
double difference_at_stops(const FeedDriveParams& p, const Stretch& stretch) {
  const std::array<Tick, 0> none{};
  const DriveBank bank(std::array{p}, kTick, none, nullptr, simd_level(), std::array{stretch});
  One with_stops, in_steps;
  std::vector<LaneArray> positions(stretch.stops.size());
  double largest = 0.0;
  for (int n = 0; n < 4000; ++n) {
    with_stops.command = in_steps.command = n % 2000 < 1200 ? 8.0 * std::sin(0.005 * n) : 0.0;
    with_stops.F = in_steps.F = 50.0;
    bank.advance_with_stops(with_stops.state, with_stops.input, 0, positions);
    Tick from = 0;
    for (std::size_t stop = 0; stop <= stretch.stops.size(); ++stop) {
      const bool at_end = stop == stretch.stops.size();
      const Tick to = at_end ? stretch.step : stretch.stops[stop];
      bank.advance(in_steps.state, in_steps.input, to - from);
      from = to;
      const double x = at_end ? with_stops.at.x[0] : positions[stop][0];
      largest = std::max(largest, std::abs(x - in_steps.at.x[0]));
    }
  }
  EXPECT_EQ(DriveBank::unresolved(with_stops.state, 0), 0U);
  return largest;
}

const Stretch kOneStop = {10, {6}}, kShortPieces = {20, {2, 4, 10, 18}}, kLongPiece = {10, {8}};

TEST(DriveBank, StopsShowWhereALinearDriveIs) {
  constexpr double kRoundingTol = 1e-14;  // m, of a way of 0.3 m in ten thousand steps
  for (const Stretch& stretch : {kOneStop, kShortPieces, kLongPiece}) {
    EXPECT_LE(difference_at_stops(x_axis(), stretch), kRoundingTol);
  }
}

TEST(DriveBank, StopsShowWhereADriveWithFrictionIs) {
  constexpr double kPositionTol = 1e-10;  // m, as close as both are to CVODE (agreement_test.cpp)
  for (const FrictionKind kind :
       {FrictionKind::set_valued, FrictionKind::regularised, FrictionKind::lugre}) {
    for (const Stretch& stretch : {kOneStop, kShortPieces, kLongPiece}) {
      EXPECT_LE(difference_at_stops(with_friction(kind), stretch), kPositionTol);
    }
  }
}

// To and fro through both zones of friction and the standstill between them: the largest difference
// (m) between a lane of the bank and its exact step.
double difference_from_exact_step(FrictionKind kind, Tick step) {
  const FeedDriveParams p = with_friction(kind);
  const DriveBank bank = bank_of(p, {step});
  const ExactStep exact(p, kTick, step);
  One s;
  LaneState lane;
  double fastest = 0.0, largest = 0.0;
  int standing = 0;
  for (int n = 0; n < 2000; ++n) {
    s.command = n % 1000 < 600 ? 8.0 * std::sin(0.01 * n) : 0.0;
    s.F = 50.0;
    bank.advance(s.state, s.input, step);
    exact.advance(lane, s.command, s.F, step);
    largest = std::max(largest, std::abs(s.at.x[0] - lane.x));
    fastest = std::max(fastest, std::abs(s.at.v[0]));
    if (std::abs(s.at.v[0]) < 1e-4) ++standing;  // m/s
  }
  EXPECT_GT(fastest, 0.05);  // both were seen
  EXPECT_GT(standing, 20);
  EXPECT_EQ(DriveBank::unresolved(s.state, 0), 0U);
  return largest;
}

TEST(DriveBank, LanesWithFrictionMoveAsTheirExactStepSays) {
  constexpr double kPositionTol = 1e-14;  // m, rounding: constant force against collocation
  EXPECT_LE(difference_from_exact_step(FrictionKind::set_valued, 20), kPositionTol);
}

TEST(DriveBank, LanesWithSmoothFrictionDoSoInSubStepsOfTheirOwn) {
  constexpr double kPositionTol = 1e-10;  // m, as close as both are to CVODE (agreement_test.cpp)
  for (const FrictionKind kind : {FrictionKind::regularised, FrictionKind::lugre}) {
    for (const Tick step : {16, 20}) {
      EXPECT_LE(difference_from_exact_step(kind, step), kPositionTol) << step;
    }
  }
}

}  // namespace
}  // namespace servomill::plant::drive_bank_test
