#include "plant/drives/screw_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::plant::screw_error_test {
namespace {

constexpr double kRounding = 1e-18;  // m, of errors below 100 um
constexpr double kR = 20 * mm / (2 * std::numbers::pi);

ScrewGrowth warming() {
  ScrewGrowth growth;
  growth.alpha = 11.5e-6;
  growth.x_fixed = -0.4;
  growth.dT_end = 8.0;
  growth.tau = 1800.0;
  return growth;
}

TEST(ScrewGrowth, IsAlphaTimesRiseTimesDistanceFromTheFixedBearing) {
  const ScrewError screw{{}, warming()};
  EXPECT_EQ(screw.at(-0.4, 1e9), 0.0);
  EXPECT_NEAR(screw.at(0.1, 1e9), 46 * um, kRounding);     // 11.5e-6 * 8 * 0.5
  EXPECT_NEAR(screw.at(-0.5, 1e9), -9.2 * um, kRounding);  // beyond the bearing it grows away
}

TEST(ScrewGrowth, WarmsExponentially) {
  const ScrewGrowth growth = warming();
  EXPECT_EQ(growth.rise(0.0), 0.0);
  EXPECT_NEAR(growth.rise(1800.0), 8.0 * (1.0 - std::exp(-1.0)), 1e-14);
  EXPECT_NEAR(growth.rise(1800.0 * std::log(2.0)), 4.0, 1e-14);
  EXPECT_EQ(growth.rise(1e9), 8.0);
  EXPECT_EQ(growth.rise(-1.0), 0.0);
  // the first moments, where 1 - exp would lose its digits
  EXPECT_NEAR(growth.rise(1e-6) / (8.0 * 1e-6 / 1800.0), 1.0, 1e-9);
}

TEST(ScrewGrowth, IsThereAtOnceWithoutTimeConstant) {
  ScrewGrowth growth = warming();
  growth.tau = 0.0;
  EXPECT_EQ(growth.rise(0.0), 8.0);
}

TEST(ScrewError, AddsLeadAndGrowth) {
  const ScrewError lead{harmonic(3 * um, 20 * mm, 0.7) + polynomial({0.0, 20e-6}), {}};
  const ScrewError both{lead.lead, warming()};
  const ScrewError growth{{}, warming()};
  for (const double x : {-0.3, 0.0, 0.017, 0.25}) {
    EXPECT_EQ(lead.at(x, 500.0), lead.lead.value(x));
    EXPECT_NEAR(both.at(x, 500.0), lead.at(x, 500.0) + growth.at(x, 500.0), kRounding);
  }
}

TEST(ScrewError, SlopeIsItsDerivative) {
  const ScrewError screw{harmonic(3 * um, 20 * mm, 0.7), warming()};
  constexpr double h = 1e-6, kTol = 1e-10;  // 1: third derivative 9e1 h^2 / 6, rounding 1e-20 / h
  for (const double x : {-0.3, 0.001, 0.25}) {
    const double difference = (screw.at(x + h, 900.0) - screw.at(x - h, 900.0)) / (2 * h);
    EXPECT_NEAR(screw.slope(x, 900.0), difference, kTol);
  }
}

TEST(ScrewError, IsZeroOnlyWithoutLeadAndGrowth) {
  EXPECT_TRUE(ScrewError{}.is_zero());
  EXPECT_FALSE((ScrewError{constant(1 * nm), {}}.is_zero()));
  EXPECT_FALSE((ScrewError{{}, warming()}.is_zero()));
}

TEST(MotorAngle, OfAPerfectScrewIsTheTravelOverTheLead) {
  for (const double x : {-0.3, 0.0, 1.0 / 3.0}) EXPECT_EQ(motor_angle({}, kR, x, 10.0), x / kR);
}

TEST(MotorAngle, FallsShortWhereTheSlideIsAhead) {
  const ScrewError screw{constant(5 * um), {}};
  EXPECT_NEAR(motor_angle(screw, kR, 0.1, 0.0), (0.1 - 5 * um) / kR, 1e-14);
}

// Closing the loop at the motor: r phi = target. The slide then stands at target + e.
TEST(MotorAngle, LeavesTheWholeErrorToTheSlide) {
  const ScrewError screw{harmonic(3 * um, 20 * mm), warming()};
  for (const double target : {-0.2, 0.013, 0.3}) {
    double X = target;
    for (int n = 0; n < 10; ++n) X += target - kR * motor_angle(screw, kR, X, 3600.0);
    EXPECT_NEAR(X - target, screw.at(X, 3600.0), 1e-15);
    EXPECT_GT(std::abs(X - target), 1 * um);
  }
}

// 300 mm of the cold screw are 300 mm (1 + alpha dT) of the warm one; what the model leaves out is
// of second order.
TEST(MotorAngle, OfAGrownScrewIsThatOfItsLongerLeadToSecondOrder) {
  const ScrewError screw{{}, warming()};
  const double stretch = 11.5e-6 * 8.0;
  const double exact = (0.3 / (1.0 + stretch)) / kR;
  const double modelled = motor_angle(screw, kR, -0.4 + 0.3, 1e9) - motor_angle(screw, kR, -0.4, 0);
  EXPECT_NEAR(modelled, exact, 1.01 * 0.3 * stretch * stretch / kR);
  EXPECT_GT(std::abs(modelled - exact), 0.99 * 0.3 * stretch * stretch / kR);
}

TEST(Implausible, NamesWhatNoScrewCanBe) {
  ScrewGrowth growth = warming();
  EXPECT_TRUE(implausible(growth).empty());
  growth.tau = -1.0;
  growth.alpha = std::nan("");
  EXPECT_EQ(implausible(growth),
            (std::vector<std::string>{"alpha must be >= 0", "tau must be >= 0"}));
}

}  // namespace
}  // namespace servomill::plant::screw_error_test
