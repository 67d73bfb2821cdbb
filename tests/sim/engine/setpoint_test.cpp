#include "sim/engine/setpoint.h"

#include <gtest/gtest.h>

#include "plant/kinematics/chain.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::engine::setpoint_test {
namespace {

constexpr double kTp = 200e-6;  // s

// Y is displaced in proportion to X.
class Proportional final : public strategies::SetpointPart {
 public:
  Proportional(EntryPoint where, double slope, double dead_time)
      : entry_{where, 0.0, dead_time, 0.0}, slope_(slope) {}
  SetpointEntry entry() const override { return entry_; }
  Joints offset(const Joints& Q_ref) const override {
    return {0.0, slope_ * Q_ref[0], 0.0, 0.0, 0.0};
  }

 private:
  SetpointEntry entry_;
  double slope_;
};

constexpr double kSlope = 0.01;

controllers::Trajectory along_x() {
  const plant::MachineChain chain =
      plant::make_chain(plant::parse_structure("[w C' B' X b Y Z t]"));
  Move move;
  move.line = 1;
  move.end[0] = move.end_machine[0] = 40.0 * mm;
  move.s_end = 40.0 * mm;
  move.feed = 50.0 * mm;
  Joints start = Joints::Zero();
  start[0] = 10.0 * mm;
  controllers::JointLimits limits;
  limits.v.setConstant(0.5);
  limits.a.setConstant(5.0);
  limits.j.setConstant(100.0);
  return controllers::plan(std::vector<Move>{move}, chain.layout, start, limits);
}

std::vector<std::unique_ptr<strategies::SetpointPart>> one_part(EntryPoint where,
                                                                double dead_time = 0.0) {
  std::vector<std::unique_ptr<strategies::SetpointPart>> parts;
  parts.push_back(std::make_unique<Proportional>(where, kSlope, dead_time));
  return parts;
}

model::NcSettings nc_with_filter(Tick length = 0) {
  model::NcSettings nc;
  nc.filter.length = length;
  return nc;
}

class SetpointOf : public testing::Test {
 protected:
  const controllers::Trajectory trajectory_ = along_x();
  controllers::Trajectory::Sample at(double t) {
    controllers::Trajectory::Cursor cursor;
    return trajectory_.at(t, cursor);
  }
  std::size_t periods() const {
    return static_cast<std::size_t>(trajectory_.duration() / kTp) + 50;
  }
};

TEST_F(SetpointOf, NothingIsTheTrajectoryItself) {
  Setpoint setpoint(nc_with_filter(), trajectory_, {});
  EXPECT_EQ(setpoint.settle().Q_cmd, trajectory_.start());
  EXPECT_EQ(setpoint.delay(), 0.0);
  controllers::Trajectory::Cursor cursor;
  for (std::size_t k = 0; k < periods(); ++k) {
    const double t = static_cast<double>(k) * kTp;
    const auto wanted = trajectory_.at(t, cursor);
    const AxisSetpoint& out = setpoint.advance(at(t));
    EXPECT_EQ(out.Q_ref, wanted.Q_ref);
    EXPECT_EQ(out.Q_cmd, wanted.Q_ref);
    EXPECT_EQ(out.dQ_ff, wanted.dQ_ref);
    EXPECT_EQ(out.ddQ_ff, wanted.ddQ_ref);
  }
}

// Behind the feed-forward tap: the command changes, what is fed forward does not, bit for bit.
TEST_F(SetpointOf, APositionCommandIsNotFedForward) {
  Setpoint plain(nc_with_filter(), trajectory_, {});
  Setpoint corrected(nc_with_filter(), trajectory_, one_part(EntryPoint::position_command));
  EXPECT_EQ(corrected.settle().Q_cmd[1], kSlope * 10.0 * mm);
  for (std::size_t k = 0; k < periods(); ++k) {
    const double t = static_cast<double>(k) * kTp;
    const AxisSetpoint without = plain.advance(at(t)), with = corrected.advance(at(t));
    EXPECT_EQ(with.Q_ref, without.Q_ref);
    EXPECT_EQ(with.Q_cmd[1], kSlope * without.Q_ref[0]);
    EXPECT_EQ(with.dQ_ff, without.dQ_ff);
    EXPECT_EQ(with.ddQ_ff, without.ddQ_ff);
  }
}

// Fed forward: velocity and acceleration are its differences over a period.
TEST_F(SetpointOf, AFedForwardCorrectionHasItsRate) {
  Setpoint corrected(nc_with_filter(), trajectory_, one_part(EntryPoint::feed_forward));
  corrected.settle();
  // mean over a period against its end: half a period late, at up to 100 m/s^3 of X
  constexpr double kRateTol = kSlope * 5.0 * 0.5 * kTp;
  constexpr double kAccelerationTol = kSlope * 100.0 * kTp * (1.0 + 1e-6);  // reached, rounded
  double y = kSlope * 10.0 * mm, largest_rate = 0.0;
  for (std::size_t k = 0; k < periods(); ++k) {
    const AxisSetpoint& out = corrected.advance(at(static_cast<double>(k) * kTp));
    EXPECT_EQ(out.Q_cmd[1], kSlope * out.Q_ref[0]);
    EXPECT_NEAR(out.dQ_ff[1], (out.Q_cmd[1] - y) / kTp, 1e-12);
    EXPECT_NEAR(out.dQ_ff[1], kSlope * out.dQ_ff[0], kRateTol);
    EXPECT_NEAR(out.ddQ_ff[1], kSlope * out.ddQ_ff[0], kAccelerationTol);
    y = out.Q_cmd[1];
    largest_rate = std::max(largest_rate, out.dQ_ff[1]);
  }
  EXPECT_NEAR(largest_rate, kSlope * 50.0 * mm, 1e-9);
}

// Before the filter: the correction is filtered like the position, so that it stays in proportion.
TEST_F(SetpointOf, ACorrectionBeforeTheFilterPassesIt) {
  Setpoint corrected(nc_with_filter(25), trajectory_, one_part(EntryPoint::before_filter));
  corrected.settle();
  EXPECT_DOUBLE_EQ(corrected.delay(), 12.0 * kTp);
  controllers::Trajectory::Cursor cursor;
  constexpr double kRounding = 1e-15;  // m, of a running sum of 25 positions
  double behind = 0.0;
  for (std::size_t k = 0; k < periods(); ++k) {
    const double t = static_cast<double>(k) * kTp;
    const AxisSetpoint& out = corrected.advance(at(t));
    EXPECT_NEAR(out.Q_cmd[1], kSlope * out.Q_ref[0], kRounding);
    behind = std::max(behind, trajectory_.at(t, cursor).Q_ref[0] - out.Q_ref[0]);
  }
  EXPECT_NEAR(behind, 12.0 * kTp * 50.0 * mm, kRounding);
}

TEST_F(SetpointOf, ACorrectionWithDeadTimeIsTheOneOfBefore) {
  Setpoint corrected(nc_with_filter(), trajectory_,
                     one_part(EntryPoint::position_command, 5.0 * kTp));
  std::vector<double> x(5, corrected.settle().Q_ref[0]);
  for (std::size_t k = 0; k < periods(); ++k) {
    const AxisSetpoint& out = corrected.advance(at(static_cast<double>(k) * kTp));
    x.push_back(out.Q_ref[0]);
    EXPECT_EQ(out.Q_cmd[1], kSlope * x[k]);
  }
}

// Parts of several strategies add up.
TEST_F(SetpointOf, CorrectionsAddUp) {
  auto parts = one_part(EntryPoint::position_command);
  parts.push_back(std::make_unique<Proportional>(EntryPoint::feed_forward, 2.0 * kSlope, 0.0));
  Setpoint corrected(nc_with_filter(), trajectory_, std::move(parts));
  constexpr double kRounding = 1e-18;  // m
  EXPECT_NEAR(corrected.settle().Q_cmd[1], 3.0 * kSlope * 10.0 * mm, kRounding);
  for (std::size_t k = 0; k < periods(); ++k) {
    const AxisSetpoint& out = corrected.advance(at(static_cast<double>(k) * kTp));
    EXPECT_NEAR(out.Q_cmd[1], 3.0 * kSlope * out.Q_ref[0], kRounding);
  }
}

}  // namespace
}  // namespace servomill::sim::engine::setpoint_test
