#include "plant/geometry/reversal_memory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "tests/plant/kinematics/all_structures.h"

namespace servomill::plant::reversal_memory_test {
namespace {

constexpr double kRounding = 1e-12;  // of 1: quotients of travel below 1 m by tens of micrometres
constexpr Play kPlay{0, 20 * um};

// An axis X alone.
class OneAxis {
 public:
  explicit OneAxis(double at) : memory_({&kPlay, 1}, Joints::Unit(0) * at) {}
  double go_to(double q) {
    memory_.travel(Joints::Unit(0) * q);
    return at(q);
  }
  double at(double q) const {
    double direction = 0.0;
    memory_.directions(Joints::Unit(0) * q, {&direction, 1});
    return direction;
  }

 private:
  ReversalMemory memory_;
};

TEST(ReversalMemory, IsEmptyWhereNothingHasToBeRemembered) {
  const ReversalMemory none;
  EXPECT_TRUE(none.empty());
  none.directions(Joints::Ones(), {});
}

TEST(ReversalMemory, StandsInTheMiddleUntilTheAxisMoves) {
  const OneAxis axis(0.3);
  EXPECT_EQ(axis.at(0.3), 0.0);
}

TEST(ReversalMemory, KnowsTheDirectionAfterTheDistanceOfAReversal) {
  OneAxis axis(0.0);
  EXPECT_NEAR(axis.go_to(10 * um), 1.0, kRounding);
  EXPECT_NEAR(axis.go_to(100 * mm), 1.0, kRounding);
  EXPECT_NEAR(axis.go_to(100 * mm - 20 * um), -1.0, kRounding);
  EXPECT_NEAR(axis.go_to(-30 * mm), -1.0, kRounding);
  EXPECT_NEAR(axis.go_to(-30 * mm + 20 * um), 1.0, kRounding);
}

TEST(ReversalMemory, ChangesOverAsStatedOnEachMicrometreOfAReversal) {
  for (const double sense : {1.0, -1.0}) {
    OneAxis axis(0.0);
    axis.go_to(sense * 50 * mm);
    for (int back = 0; back <= 25; ++back) {
      const double u = std::max(1.0 - back / 10.0, -1.0);
      EXPECT_NEAR(axis.go_to(sense * (50 * mm - back * um)), sense * u * (3.0 - u * u) / 2.0,
                  kRounding)
          << back;
    }
  }
}

TEST(ReversalMemory, HasNeitherJumpNorKink) {
  OneAxis axis(0.0);
  constexpr double kStep = 0.01 * um;
  constexpr double kSteepest = 1.5 / (0.5 * 20 * um);                // 1/m, in the middle
  constexpr double kBend = 3.0 / (0.5 * 20 * um) / (0.5 * 20 * um);  // 1/m^2, at the ends
  double before = axis.go_to(1 * mm), slope_before = 0.0;
  for (int n = 1; n < 3000; ++n) {
    const double now = axis.go_to(1 * mm - n * kStep), slope = (now - before) / kStep;
    EXPECT_LE(std::abs(slope), kSteepest * (1.0 + 1e-6));
    EXPECT_LE(std::abs(slope - slope_before), 1.001 * kBend * kStep) << n;
    before = now;
    slope_before = slope;
  }
}

// Motions to and fro within the distance go on where they were, on one curve.
TEST(ReversalMemory, KeepsWhatSmallerMotionsLeave) {
  OneAxis axis(0.0);
  axis.go_to(5 * mm);
  const double down = axis.go_to(5 * mm - 8 * um);
  axis.go_to(5 * mm - 15 * um);
  EXPECT_NEAR(axis.go_to(5 * mm - 8 * um), down, kRounding);
  EXPECT_NEAR(axis.go_to(5 * mm), 1.0, kRounding);
}

TEST(ReversalMemory, DependsOnTurningPointsOnlyNotOnWhenItIsAsked) {
  Uniform random(7);
  for (int n = 0; n < 200; ++n) {
    OneAxis once(0.0), often(0.0);
    double from = 0.0;
    for (int turn = 0; turn < 10; ++turn) {
      const double to = 40 * um * random();
      once.go_to(to);
      for (int k = 1; k < 7; ++k) often.go_to(from + (to - from) * k / 7.0);
      often.go_to(to);
      from = to;
    }
    EXPECT_EQ(once.at(from), often.at(from));
  }
}

TEST(ReversalMemory, IsNotChangedByBeingAsked) {
  OneAxis axis(0.0);
  axis.go_to(1 * mm);
  EXPECT_NEAR(axis.at(0.0), -1.0, kRounding);
  EXPECT_NEAR(axis.at(1 * mm), 1.0, kRounding);
}

}  // namespace
}  // namespace servomill::plant::reversal_memory_test
