#include "sim/engine/axis_demands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controllers/path/trajectory.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::engine {
namespace {

constexpr double kT = 0.2 * ms;
constexpr double kRounding = 1e-6;  // share: third differences of 0.1 m over 0.2 ms
constexpr std::size_t kX = 0, kY = 1;

Joints along(std::size_t joint, double value) {
  Joints out = Joints::Zero();
  out[static_cast<int>(joint)] = value;
  return out;
}

// Demands of a motion along X with an offset of Y, both functions of time.
template <class Path, class Offset>
AxisDemands demands(double duration, Path path, Offset offset, std::size_t periods = 1) {
  DemandMeter meter(kT, periods);
  meter.start(along(kX, path(0.0)), along(kY, offset(0.0)));
  for (double n = 1.0; n * kT <= duration; n += 1.0) {
    meter.add(n * kT, along(kX, path(n * kT)), along(kY, offset(n * kT)));
  }
  return meter.demands();
}

double none(double) { return 0.0; }

TEST(DemandMeter, OfAnAxisAtStandstillFindsItsOffsetAlone) {
  const AxisDemands found = demands(
      0.1, [](double) { return 0.3; }, [](double) { return -5.0 * um; });
  EXPECT_DOUBLE_EQ(found.offset[kY].size, 5.0 * um);
  EXPECT_EQ(found.offset[kX].size, 0.0);
  for (const auto& order : found.motion) {
    for (const Peak& joint : order) EXPECT_EQ(joint.size, 0.0);
  }
}

// x = j t^3 / 6: jerk, acceleration and velocity at the end are those of a cubic, whose mean over
// a window is its value in the middle (velocity: to h^2 / 24 of the jerk).
TEST(DemandMeter, OfACubicFindsItsDerivativesInTheMiddleOfTheWindow) {
  constexpr double j = 50.0, kEnd = 0.1;
  const AxisDemands found = demands(
      kEnd, [](double t) { return j * t * t * t / 6.0; }, none);
  const double t_v = kEnd - 0.5 * kT, t_a = kEnd - kT;
  EXPECT_NEAR(found.motion[0][kX].size, 0.5 * j * t_v * t_v + j * kT * kT / 24.0, kRounding * 0.25);
  EXPECT_NEAR(found.motion[1][kX].size, j * t_a, kRounding * 5.0);
  EXPECT_NEAR(found.motion[2][kX].size, j, kRounding * j);
  EXPECT_NEAR(found.motion[0][kX].time, t_v, 1e-9);
  EXPECT_NEAR(found.motion[1][kX].time, t_a, 1e-9);
}

// Table with linear interpolation over X: its kink changes the velocity of Y within a period.
TEST(DemandMeter, OfAKinkFindsTheStepOfTheVelocityOverAPeriod) {
  constexpr double kFeed = 0.1, kSlope = 1e-4, kAt = 0.05;
  const AxisDemands found = demands(
      0.1, [](double t) { return kFeed * t; },
      [](double t) { return kSlope * kFeed * std::max(0.0, t - kAt); });
  EXPECT_NEAR(found.motion[0][kY].size, kSlope * kFeed, kRounding * kSlope * kFeed);
  EXPECT_NEAR(found.motion[1][kY].size, kSlope * kFeed / kT, 1e-4 * kSlope * kFeed / kT);
  EXPECT_NEAR(found.motion[2][kY].size, kSlope * kFeed / (kT * kT),
              1e-4 * kSlope * kFeed / (kT * kT));
  EXPECT_NEAR(found.motion[1][kY].time, kAt, kT);
}

TEST(DemandMeter, AddsPathAndOffsetWithTheirSigns) {
  const auto path = [](double t) { return 0.5 * t; };
  DemandMeter with(kT), against(kT);
  for (DemandMeter* one : {&with, &against}) one->start(Joints::Zero(), Joints::Zero());
  for (double n = 1.0; n < 100.0; n += 1.0) {
    with.add(n * kT, along(kX, path(n * kT)), along(kX, 0.1 * n * kT));
    against.add(n * kT, along(kX, path(n * kT)), along(kX, -0.1 * n * kT));
  }
  EXPECT_NEAR(with.demands().motion[0][kX].size, 0.6, kRounding);
  EXPECT_NEAR(against.demands().motion[0][kX].size, 0.4, kRounding);
}

// Law: a planned motion, which keeps limits, gives no mean beyond them; it is at each of them for
// longer than the window, at the acceleration for little more.
TEST(DemandMeter, OfAPlannedMotionFindsItsLimits) {
  constexpr double kReached = 0.97;
  const JointLayout layout{{Axis::X, Axis::Y, Axis::Z, Axis::B, Axis::C}};
  const controllers::JointLimits limits = {Joints::Constant(0.2), Joints::Constant(4.0),
                                           Joints::Constant(80.0)};
  Move move;
  move.feed = 10.0;
  move.end = move.end_machine = layout.words(along(kX, 0.1));
  move.s_end = 0.1;
  const controllers::Trajectory path =
      controllers::plan(std::vector<Move>{move}, layout, Joints::Zero(), limits);
  controllers::Trajectory::Cursor cursor{};
  for (const std::size_t periods : {1U, 15U}) {
    const AxisDemands found = demands(
        path.duration(), [&](double t) { return path.at(t, cursor).Q_ref[0]; }, none, periods);
    const double expected[] = {0.2, 4.0, 80.0};
    for (std::size_t order = 0; order < 3; ++order) {
      EXPECT_LE(found.motion[order][kX].size, (1.0 + kRounding) * expected[order]);
      EXPECT_GE(found.motion[order][kX].size, kReached * expected[order]) << periods << order;
    }
    cursor = {};
  }
}

// Steps of 20 nm are a jerk of 20 nm / T^3 over a period, and 3375 times less over 15 of them.
TEST(DemandMeter, HearsStepsOfReadingsLessOverLongerSteps) {
  constexpr double kStep = 20e-9;
  const auto steps = [&](double t) { return kStep * std::floor(t / (40.0 * kT)); };
  EXPECT_NEAR(demands(0.2, none, steps).motion[2][kY].size, 2.0 * kStep / std::pow(kT, 3), 1.0);
  EXPECT_LE(demands(0.2, none, steps, 15).motion[2][kY].size, 4.0 * kStep / std::pow(15.0 * kT, 3));
}

TEST(LoopDisplacement, IsAFirstOrderLagOfWhatIsWanted) {
  constexpr double Kv = 80.0, kWanted = 10.0 * um;
  LoopDisplacement loop(Joints::Constant(Kv), kT);
  loop.start(Joints::Zero());
  for (double n = 1.0; n <= 200.0; n += 1.0) {
    const double d = loop.advance(along(kX, kWanted), Joints::Zero())[0];
    ASSERT_NEAR(d, kWanted * -std::expm1(-Kv * n * kT), 1e-9 * kWanted);
  }
}

TEST(LoopDisplacement, OfAddedVelocitiesIsTheirShareOfTheGain) {
  constexpr double Kv = 80.0, kVelocity = 1.0 * mm;
  LoopDisplacement loop(along(kX, Kv), kT);
  Joints d = Joints::Zero();
  for (int n = 0; n < 5000; ++n) d = loop.advance(Joints::Zero(), Joints::Constant(kVelocity));
  EXPECT_NEAR(d[0], kVelocity / Kv, 1e-12);
  EXPECT_EQ(d[1], 0.0) << "has no loop";
}

TEST(LoopDisplacement, BeginsAtRest) {
  LoopDisplacement loop(Joints::Constant(80.0), kT);
  loop.start(Joints::Constant(3.0 * um));
  EXPECT_DOUBLE_EQ(loop.advance(Joints::Constant(3.0 * um), Joints::Zero())[2], 3.0 * um);
}

TEST(PeriodsOfReadings, AreAQuarterOfTheShortestTimeConstant) {
  Joints Kv = Joints::Constant(20.0);
  Kv[3] = 83.3;  // 12 ms: 3 ms, 15 periods
  EXPECT_EQ(periods_of_readings(Kv, kT), 15U);
  EXPECT_EQ(periods_of_readings(Joints::Zero(), kT), 1U) << "no loops";
  EXPECT_EQ(periods_of_readings(Joints::Constant(1e4), kT), 1U) << "faster than it is sampled";
}

}  // namespace
}  // namespace servomill::sim::engine
