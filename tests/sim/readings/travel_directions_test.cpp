// Directions of travel of the joints, from those of the rows.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/readings/read_rows.h"
#include "tests/sim/readings/reading_files.h"

namespace servomill::sim::readings::travel_directions_test {
namespace {

TEST(TravelDirections, WordsOfEitherCase) {
  for (const char* word : {"forward", "Up", "POSITIVE", "+", "+1", "ccw"}) {
    EXPECT_EQ(direction_of(word), 1) << word;
  }
  for (const char* word : {"backward", "Down", "neg", "-", "-1", "CW"}) {
    EXPECT_EQ(direction_of(word), -1) << word;
  }
  EXPECT_FALSE(direction_of("left"));
}

Group circle_of(const std::vector<double>& angles) {
  Group out;
  out.kind = Kind::circle;
  out.radius = 0.1;
  for (const double angle : angles) {
    Reading row;
    row.Q[0] = 0.1 * std::cos(angle);
    row.Q[1] = 0.1 * std::sin(angle);
    out.rows.push_back(row);
  }
  return out;
}

// Counter-clockwise at 0 degrees X turns round, Y rises; at 45 degrees X falls.
TEST(TravelDirections, OnACircleTheTangentAndNoneOfTheAxisThatTurnsRound) {
  Group circle = circle_of({0.0, std::numbers::pi / 4.0, std::numbers::pi});
  set_directions(circle, gantry().layout, {1, 1, -1});
  EXPECT_EQ(circle.rows[0].direction[0], 0);
  EXPECT_EQ(circle.rows[0].direction[1], 1);
  EXPECT_EQ(circle.rows[1].direction[0], -1);
  EXPECT_EQ(circle.rows[1].direction[1], 1);
  EXPECT_EQ(circle.rows[2].direction[0], 0);
  EXPECT_EQ(circle.rows[2].direction[1], 1);
}

// X = cos C falls and rises as C counts up, whatever the order of the rows.
TEST(TravelDirections, LinearAxesFollowTheRotaryOneOfAnRTest) {
  Group test;
  test.kind = Kind::r_test;
  for (const double angle : {0.5, 4.0, 2.0, 1.0, 3.0, 5.0}) {
    Reading row;
    row.Q[0] = std::cos(angle);
    row.Q[4] = angle;
    test.rows.push_back(row);
  }
  set_directions(test, gantry().layout, {1, 1, 1, -1, -1, 1});
  const int expected[] = {-1, 1, -1, 1, 1, 1};  // of X: C rises, rises, rises, falls, falls, rises
  for (std::size_t i = 0; i < test.rows.size(); ++i) {
    EXPECT_EQ(test.rows[i].direction[4], i == 3 || i == 4 ? -1 : 1) << i;
    EXPECT_EQ(test.rows[i].direction[0], expected[i]) << i;
  }
  EXPECT_FALSE(test.directions_unused);
}

TEST(TravelDirections, SayNothingWhereTwoRotaryAxesMoveOrNone) {
  Group test;
  test.kind = Kind::r_test;
  test.rows.resize(2);
  set_directions(test, gantry().layout, {1, 1});
  EXPECT_TRUE(test.directions_unused);
  test.directions_unused = false;
  test.rows[1].Q[3] = test.rows[1].Q[4] = 1.0;
  set_directions(test, gantry().layout, {1, 1});
  EXPECT_TRUE(test.directions_unused);
  test.directions_unused = false;
  set_directions(test, gantry().layout, {0, 0});
  EXPECT_FALSE(test.directions_unused);
}

}  // namespace
}  // namespace servomill::sim::readings::travel_directions_test
