/// Motion that the spindle turns with: from rest to rest, no quicker than the spindle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controllers/path/trajectory.h"
#include "tests/controllers/path/programs.h"

namespace servomill::controllers::test::synchronised_motion_test {
namespace {

constexpr double kRounding = 1e-9;
constexpr double kLead = 2 * mm, kSpeed = 40.0 * mm;  // m a revolution; m/s
constexpr double kAcceleration = 500.0;               // rad/s2, of the spindle

double way_acceleration() { return kAcceleration * kLead / (2.0 * std::numbers::pi); }

// A rapid, a tap of 20 mm and a feed that goes on from it.
std::vector<Move> tapping(double lead = kLead) {
  Program program;
  program.rapid(kLayout.words(Joints{{0.05, 0.0, 0.0, 0.0, 0.0}}));
  program.line(0.05, 0, -20 * mm, kSpeed).line(0.05, 0, 0, kSpeed).line(0.05, 0, 10 * mm, kSpeed);
  std::vector<Move> moves = program.moves();
  for (const std::size_t i : {1U, 2U}) {
    moves[i].synchronised = i == 1 ? Synchronised::tap_in : Synchronised::tap_out;
    moves[i].value = lead;
    moves[i].path_mode = PathMode::exact_stop;
  }
  return moves;
}

Trajectory planned(const std::vector<Move>& moves, const PathOptions& options) {
  return plan(moves, kLayout, Joints::Zero(), machine_limits(), options);
}

double largest_acceleration(const Trajectory& path, double from, double to) {
  double most = 0.0;
  Trajectory::Cursor cursor;
  for (double t = from; t <= to; t += 50 * us) {
    most = std::max(most, path.at(t, cursor).ddQ_ref.cwiseAbs().maxCoeff());
  }
  return most;
}

TEST(SynchronisedMotion, GoesFromRestToRestWithTheAccelerationOfTheSpindle) {
  PathOptions options;
  options.spindle_acceleration = kAcceleration;
  const Trajectory path = planned(tapping(), options);
  ASSERT_EQ(path.chains(), 4U);  // rapid, in, out, feed
  const double v = kSpeed, a = way_acceleration(), j = machine_limits().j[2];
  for (const std::size_t i : {1U, 2U}) {
    const auto held = path.chain(i);
    const Trajectory::Chain& chain = *held;
    EXPECT_NEAR(chain.duration, 20 * mm / v + v / a + a / j, kRounding);
    EXPECT_NEAR(largest_acceleration(path, chain.t, chain.t + chain.duration), a, 1e-6);
  }
}

TEST(SynchronisedMotion, TakesTheAccelerationOfTheAxesWhereTheSpindleIsQuicker) {
  const Trajectory path = planned(tapping(), {});
  const double v = kSpeed, j = machine_limits().j[2];
  EXPECT_NEAR(path.chain(1)->duration, 20 * mm / v + 2.0 * std::sqrt(v / j), kRounding);
}

TEST(SynchronisedMotion, IsAsQuickWithALeadOfTheOtherSign) {
  PathOptions options;
  options.spindle_acceleration = kAcceleration;
  EXPECT_EQ(planned(tapping(-kLead), options).duration(), planned(tapping(), options).duration());
}

// The feed override would take the tap out of its thread.
TEST(SynchronisedMotion, KeepsItsFeedUnderAFeedOverride) {
  PathOptions slow;
  slow.feed_override = 0.5;
  const Trajectory half = planned(tapping(), slow), whole = planned(tapping(), {});
  EXPECT_EQ(half.chain(1)->duration, whole.chain(1)->duration);
  EXPECT_GT(half.chain(3)->duration, 1.5 * whole.chain(3)->duration);
}

TEST(SynchronisedMotion, OfRepeatedTapsIsThatOfTheFirst) {
  std::vector<Move> moves = tapping(), again = tapping();
  for (Move& move : again) {
    if (move.kind == MoveKind::rapid) continue;
    moves.push_back(move);
  }
  PathOptions options;
  options.spindle_acceleration = kAcceleration;
  moves.erase(moves.begin() + 3);  // the feed between them
  const Trajectory path = planned(moves, options);
  EXPECT_EQ(path.chain(1)->duration, path.chain(3)->duration);
  // the same way without the spindle is planned anew
  moves[3].synchronised = Synchronised::no;
  EXPECT_LT(planned(moves, options).chain(3)->duration, path.chain(1)->duration);
}

}  // namespace
}  // namespace servomill::controllers::test::synchronised_motion_test
