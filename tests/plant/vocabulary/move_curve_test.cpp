#include "plant/vocabulary/move_curve.h"

#include <gtest/gtest.h>

#include <numbers>

namespace servomill::move_curve_test {
namespace {

constexpr double kRoundingTol = 1e-15;  // m, a few operations at 0.1 m
constexpr double kPi = std::numbers::pi;

AxisWords point(double x, double y, double z) {
  AxisWords p = AxisWords::Zero();
  p.head<3>() << x, y, z;
  return p;
}

Move arc_to(const AxisWords& end, double cx, double cy, int turns) {
  Move move;
  move.kind = MoveKind::arc;
  move.end_machine = end;
  move.centre_machine << cx, cy, 0.0;
  move.arc.turns = turns;
  return move;
}

TEST(MoveCurve, LineIsStraightInAllAxes) {
  Move move;
  move.end_machine << 0.03, 0.04, 0.0, 0.0, 0.1, 0.2;
  const MoveCurve line(AxisWords::Zero(), move);
  EXPECT_DOUBLE_EQ(line.length(), 0.05);
  EXPECT_TRUE(line.at(0.5).isApprox(0.5 * move.end_machine));
  EXPECT_EQ(line.at(1.0), move.end_machine);
}

TEST(MoveCurve, QuarterArcsTurnEitherWay) {
  const MoveCurve ccw(point(0.1, 0, 0), arc_to(point(0, 0.1, 0), 0, 0, 1));
  EXPECT_NEAR(ccw.length(), 0.05 * kPi, kRoundingTol);
  EXPECT_NEAR(ccw.at(0.5)[0], 0.1 * std::sqrt(0.5), kRoundingTol);
  const MoveCurve cw(point(0.1, 0, 0), arc_to(point(0, 0.1, 0), 0, 0, -1));
  EXPECT_NEAR(cw.length(), 0.15 * kPi, kRoundingTol);
  EXPECT_NEAR(cw.at(1.0 / 3.0)[1], -0.1, kRoundingTol);
}

TEST(MoveCurve, AnArcThatEndsWhereItBeganIsAFullTurn) {
  for (const int turns : {1, -1, 3}) {
    const MoveCurve circle(point(0.1, 0, 0), arc_to(point(0.1, 0, 0), 0, 0, turns));
    EXPECT_NEAR(circle.length(), std::abs(turns) * 0.2 * kPi, kRoundingTol) << turns;
  }
}

TEST(MoveCurve, HelixLengthIsThatOfTheUnrolledTriangle) {
  const MoveCurve helix(point(0.1, 0, 0), arc_to(point(0.1, 0, 0.02), 0, 0, 2));
  EXPECT_NEAR(helix.length(), std::hypot(0.4 * kPi, 0.02), kRoundingTol);
  EXPECT_NEAR(helix.at(0.5)[2], 0.01, kRoundingTol);
}

TEST(MoveCurve, FindsItsOwnPointsAsClosest) {
  const MoveCurve arc(point(0.1, 0, 0), arc_to(point(0, -0.1, 0), 0, 0, 1));
  const MoveCurve helix(point(0.1, 0, 0), arc_to(point(0.1, 0, 0.02), 0, 0, -3));
  Move straight;
  straight.end_machine = point(0.03, 0.04, 0.01);
  const MoveCurve line(AxisWords::Zero(), straight);
  for (double t = 0.0; t <= 1.0; t += 0.0625) {
    for (const MoveCurve& curve : {arc, helix, line}) {
      EXPECT_NEAR(curve.closest(curve.at(t).head<3>()), t, 1e-12);
    }
  }
}

TEST(MoveCurve, ClosestPointIsHeldToTheEnds) {
  Move straight;
  straight.end_machine = point(0.1, 0, 0);
  const MoveCurve line(AxisWords::Zero(), straight);
  EXPECT_EQ(line.closest({-1, 0, 0}), 0.0);
  EXPECT_EQ(line.closest({1, 1, 0}), 1.0);
}

}  // namespace
}  // namespace servomill::move_curve_test
