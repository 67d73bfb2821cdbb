#include "sim/standards/axis_positioning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::sim::standards::axis_positioning_test {

constexpr double kRounding = 1e-15;  // m, sums of some terms of 1e-5

// Three targets, two runs; deviations such that each parameter follows by hand.
PositioningTest by_hand() {
  PositioningTest test;
  test.targets = Eigen::Array3d(0.0, 0.1, 0.2);
  test.up.resize(3, 2);
  test.down.resize(3, 2);
  // means up 1, 2, 6 um, down 0, 4, 3 um; s = |difference| / sqrt 2
  test.up << 1.0, 1.0, 1.0, 3.0, 6.0, 6.0;
  test.down << 0.0, 0.0, 3.0, 5.0, 3.0, 3.0;
  test.up *= um;
  test.down *= um;
  return test;
}

double value(const PositioningTest& test, Positioning which) {
  return at(positioning_parameters(evaluate_targets(test)), which);
}

TEST(Positioning, ParametersByHand) {
  const PositioningTest test = by_hand();
  const double s = std::numbers::sqrt2 * um;  // at the second target, both directions
  EXPECT_NEAR(value(test, Positioning::B), 3.0 * um, kRounding);
  EXPECT_NEAR(value(test, Positioning::B_mean), (1.0 - 2.0 + 3.0) / 3.0 * um, kRounding);
  EXPECT_NEAR(value(test, Positioning::R_up), 4.0 * s, kRounding);
  EXPECT_NEAR(value(test, Positioning::R), 4.0 * s + 2.0 * um, kRounding);
  EXPECT_NEAR(value(test, Positioning::E_up), 5.0 * um, kRounding);
  EXPECT_NEAR(value(test, Positioning::E_down), 4.0 * um, kRounding);
  EXPECT_NEAR(value(test, Positioning::E), 6.0 * um, kRounding);
  EXPECT_NEAR(value(test, Positioning::M), 4.0 * um, kRounding);
  EXPECT_NEAR(value(test, Positioning::A_up), 6.0 * um - (2.0 * um - 2.0 * s), kRounding);
  EXPECT_NEAR(value(test, Positioning::A_down), 4.0 * um + 2.0 * s, kRounding);
  EXPECT_NEAR(value(test, Positioning::A), 4.0 * um + 2.0 * s - (2.0 * um - 2.0 * s), kRounding);
}

// R of one direction counts where the other repeats better than the reversal would make up for.
TEST(Positioning, RepeatabilityOfBothDirectionsIsNoLessThanOfEach) {
  PositioningTest test = by_hand();
  test.down = test.up.rowwise().mean().replicate(1, 2);  // repeats exactly, no reversal
  EXPECT_NEAR(value(test, Positioning::R), value(test, Positioning::R_up), kRounding);
}

TEST(Positioning, BothEvaluationsAgree) {
  const PositioningTest test = by_hand();
  const auto one = positioning_parameters(evaluate_targets(test));
  const auto other = positioning_parameters(test.up, test.down);
  for (std::size_t k = 0; k < kPositioningParameters; ++k) EXPECT_EQ(one[k], other[k]);
}

TEST(Positioning, OneDirectionGivesOnlyItsOwnParameters) {
  PositioningTest test = by_hand();
  test.down.resize(0, 0);
  EXPECT_TRUE(std::isnan(value(test, Positioning::B)));
  EXPECT_TRUE(std::isnan(value(test, Positioning::R)));
  EXPECT_TRUE(std::isnan(value(test, Positioning::A)));
  EXPECT_TRUE(std::isnan(value(test, Positioning::A_down)));
  EXPECT_NEAR(value(test, Positioning::E_up), 5.0 * um, kRounding);
  const auto notes = departures(test);
  ASSERT_FALSE(notes.empty());
  EXPECT_EQ(
      notes[0],
      "readings are upwards only: bi-directional parameters (B, R, M, E, A) need both directions");
}

TEST(Positioning, OneRunGivesNoRepeatability) {
  PositioningTest test = by_hand();
  test.up.conservativeResize(3, 1);
  test.down.conservativeResize(3, 1);
  for (const Positioning which : {Positioning::R, Positioning::R_up, Positioning::A,
                                  Positioning::A_up, Positioning::A_down}) {
    EXPECT_TRUE(std::isnan(value(test, which)));
  }
  EXPECT_FALSE(std::isnan(value(test, Positioning::E)));
  EXPECT_FALSE(std::isnan(value(test, Positioning::B)));
}

TEST(Positioning, ShiftAndOrderOfRunsChangeNothing) {
  PositioningTest test = by_hand();
  const auto before = positioning_parameters(test.up, test.down);
  test.up = (test.up.rowwise().reverse() + 7.0 * um).eval();
  test.down += 7.0 * um;
  const auto after = positioning_parameters(test.up, test.down);
  for (std::size_t k = 0; k < kPositioningParameters; ++k) {
    EXPECT_NEAR(before[k], after[k], kRounding);
  }
}

TEST(Positioning, TargetsAndRunsThatTheStandardAsksFor) {
  const auto notes_of = [](double travel, int targets, int runs, bool angular) {
    PositioningTest test;
    test.angular = angular;
    test.targets = Eigen::ArrayXd::LinSpaced(targets, 0.0, travel);
    test.up = test.down = Eigen::ArrayXXd::Zero(targets, runs);
    return departures(test);
  };
  EXPECT_TRUE(notes_of(1.0, 5, 5, false).empty());
  EXPECT_EQ(notes_of(1.0, 4, 5, false).size(), 1U);
  EXPECT_EQ(notes_of(1.5, 7, 5, false).size(), 1U);
  EXPECT_EQ(notes_of(1.0, 5, 4, false).size(), 2U);  // each direction
  EXPECT_TRUE(notes_of(4.0, 17, 2, false).empty());  // beyond 2 m: every 250 mm
  EXPECT_EQ(notes_of(4.0, 16, 2, false).size(), 1U);
  EXPECT_TRUE(notes_of(360.0 * deg, 8, 5, true).empty());
  EXPECT_EQ(notes_of(360.0 * deg, 7, 5, true).size(), 1U);
  EXPECT_TRUE(notes_of(90.0 * deg, 3, 5, true).empty());
}

TEST(Positioning, PeriodicErrorIsFreeOfTheSlope) {
  constexpr double kPeriod = 2.0 * mm, kAmplitude = 0.7 * um;
  PositioningTest test;
  test.targets = Eigen::ArrayXd::LinSpaced(41, 0.0, 2.0 * kPeriod);
  const Eigen::ArrayXd wave =
      kAmplitude * (2.0 * std::numbers::pi / kPeriod * test.targets + 0.4).sin();
  test.up = (wave + 30e-6 * test.targets + 5.0 * um).replicate(1, 2);
  ASSERT_FALSE(why_no_period(test, kPeriod));
  const PeriodicError error = periodic_error(test, test.up, kPeriod);
  EXPECT_NEAR(error.amplitude, kAmplitude, 1e-12);
  EXPECT_NEAR(error.phase, 0.4, 1e-6);
  EXPECT_GT(error.P, 1.7 * kAmplitude);  // the line takes some of two periods away
  EXPECT_LT(error.P, 2.2 * kAmplitude);
  EXPECT_TRUE(why_no_period(test, 2.1 * mm));
  EXPECT_TRUE(why_no_period(test, 0.5 * mm));
}

}  // namespace servomill::sim::standards::axis_positioning_test
