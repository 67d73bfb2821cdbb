#include "sim/metrology/circular_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::sim::metrology::circular_test_test {
namespace {

using Eigen::Vector2d;
using Points = std::vector<Vector2d>;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kRounding = 1e-14;    // m, sums over thousands of lengths of 0.1 m
constexpr double kSecondOrder = 1e-8;  // m: squares of 20 um over R = 50 mm
const Circle kNominal = {{0.03, -0.02}, 50.0 * mm};

// One turn in 0.1 deg, from `start`, counter-clockwise or clockwise, displaced from the nominal
// circle by d(theta) in x, y; the last point is 0.1 deg short of the end.
Points turn_of(const std::function<Vector2d(double)>& d, Sense sense = Sense::counter_clockwise,
               double degrees = 360.0, double start = 225.0 * deg) {
  const double direction = sense == Sense::clockwise ? -1.0 : 1.0;
  Points points;
  for (int i = 0; i < static_cast<int>(std::lround(degrees * 10)); ++i) {
    const double theta = start + direction * i * 0.1 * deg;
    points.push_back(kNominal.centre +
                     kNominal.radius * Vector2d(std::cos(theta), std::sin(theta)) + d(theta));
  }
  return points;
}

// The same with a radial displacement.
Points radial_turn(const std::function<double(double)>& dr, Sense sense = Sense::counter_clockwise,
                   double degrees = 360.0) {
  return turn_of(
      [&](double theta) {
        return Vector2d(dr(theta) * Vector2d(std::cos(theta), std::sin(theta)));
      },
      sense, degrees);
}

// How far theta lies behind a place in the direction of travel, (-180, 180] deg.
double behind(double theta, double place, Sense sense) {
  return std::remainder((sense == Sense::clockwise ? -1.0 : 1.0) * (theta - place), kTurn);
}

TEST(CircularTest, OfTheNominalCircleIsZero) {
  const CircularTurn turn = evaluate_turn(turn_of([](double) { return Vector2d(0, 0); }), kNominal);
  for (const double value :
       {turn.G, turn.G_least_squares, turn.F_max, turn.F_min, turn.F_max_set_up, turn.F_min_set_up,
        turn.squareness * kNominal.radius}) {
    EXPECT_NEAR(value, 0.0, kRounding);
  }
  for (const Reversal& reversal : turn.reversals) {
    EXPECT_NEAR(reversal.spike, 0.0, kRounding);
    EXPECT_NEAR(reversal.step, 0.0, kRounding);
  }
}

TEST(CircularTest, KnowsTheDirection) {
  for (const Sense sense : {Sense::clockwise, Sense::counter_clockwise}) {
    EXPECT_EQ(evaluate_turn(radial_turn([](double) { return 0.0; }, sense), kNominal).sense, sense);
  }
}

// A circle that was set up 20 um beside: F about the set-up centre is +-20 um, about its own none.
TEST(CircularTest, TakesAnOffsetCentreOutOfAllButTheSetUpDeviation) {
  const Vector2d offset(12.0 * um, -16.0 * um);
  const CircularTurn turn = evaluate_turn(turn_of([&](double) { return offset; }), kNominal);
  EXPECT_NEAR((turn.least_squares.centre - kNominal.centre - offset).norm(), 0.0, kRounding);
  EXPECT_NEAR(turn.G, 0.0, kRounding);
  EXPECT_NEAR(turn.F_max, 0.0, kRounding);
  EXPECT_NEAR(turn.F_min, 0.0, kRounding);
  EXPECT_NEAR(turn.F_max_set_up, 20.0 * um, kSecondOrder);
  EXPECT_NEAR(turn.F_min_set_up, -20.0 * um, kSecondOrder);
}

// 5 um outward one way, 9 um the other way: circles, each without deviation.
TEST(CircularTest, DistinguishesScaleFromForm) {
  const Points ccw = radial_turn([](double) { return 5.0 * um; });
  const Points cw = radial_turn([](double) { return 9.0 * um; }, Sense::clockwise);
  const CircularTurn turn = evaluate_turn(ccw, kNominal);
  EXPECT_NEAR(turn.G, 0.0, kRounding);
  EXPECT_NEAR(turn.F_max, 5.0 * um, kRounding);
  EXPECT_NEAR(turn.F_min, 5.0 * um, kRounding);
  const BidirectionalCircle both = evaluate_both(ccw, cw, kNominal);
  EXPECT_NEAR(both.G_b, 4.0 * um, kRounding);
  EXPECT_NEAR(both.G_b_least_squares, 4.0 * um, kRounding);
  EXPECT_NEAR(both.D, -7.0 * um, kRounding) << "negative: the circle is too large";
}

// x' = x + gamma y: dr = (R gamma / 2) sin 2 theta, D45 - D135 = 2 R gamma.
TEST(CircularTest, FindsSquarenessInTheSecondHarmonic) {
  for (const double gamma : {50e-6, -20e-6}) {
    const double R = kNominal.radius;
    const Points path =
        turn_of([&](double theta) { return Vector2d(gamma * R * std::sin(theta), 0.0); });
    const CircularTurn turn = evaluate_turn(path, kNominal);
    // the uneven rest of the angle, gamma sin^2 theta, and the radius' gamma^2: second order
    EXPECT_NEAR(turn.squareness, gamma, 2.0 * gamma * gamma);
    EXPECT_NEAR(turn.G, R * std::abs(gamma), R * gamma * gamma);
    const auto curve = radial_error(path, {turn.least_squares.centre, R});
    for (const auto& [theta, dr] : curve) {
      EXPECT_NEAR(dr, 0.5 * R * gamma * std::sin(2.0 * theta), R * gamma * gamma);
    }
    const auto diameter = [&](double at) {
      double sum = 2.0 * R;
      for (const double side : {at, at + kTurn / 2}) {
        sum += std::min_element(curve.begin(), curve.end(), [&](const auto& a, const auto& b) {
                 return std::abs(a.theta - side) < std::abs(b.theta - side);
               })->dr;
      }
      return sum;
    };
    EXPECT_NEAR(diameter(45.0 * deg) - diameter(135.0 * deg), 2.0 * R * gamma,
                2e-3 * R * std::abs(gamma))
        << "0.1 deg off the diagonal";
    for (const Reversal& reversal : turn.reversals) {
      EXPECT_LT(std::abs(reversal.spike), 0.06 * 0.5 * R * std::abs(gamma));
    }
  }
}

// Different lags of the axes give the same ellipse as a squareness error, turned over with the
// direction: it is no squareness.
TEST(CircularTest, DoesNotTakeAServoMismatchForSquareness) {
  const double R = kNominal.radius, lag = 0.2e-3;  // rad: v/R times the difference of the lags
  const auto mismatch = [&](double sign) {
    return [=](double theta) { return Vector2d(sign * lag * R * std::sin(theta), 0.0); };
  };
  const Points ccw = turn_of(mismatch(1.0)), cw = turn_of(mismatch(-1.0), Sense::clockwise);
  EXPECT_NEAR(evaluate_turn(ccw, kNominal).squareness, lag, 2.0 * lag * lag);
  EXPECT_NEAR(evaluate_turn(cw, kNominal).squareness, -lag, 2.0 * lag * lag);
  EXPECT_NEAR(evaluate_both(ccw, cw, kNominal).squareness, 0.0, 2.0 * lag * lag);
  EXPECT_NEAR(evaluate_both(ccw, cw, kNominal).G_b, R * lag, R * lag * lag);
}

// Triangular glitches, 4 deg wide, that begin at the reversal: heights and places are read.
TEST(CircularTest, ReadsSpikesBehindTheReversals) {
  const std::array<double, 4> height = {10.0 * um, -6.0 * um, 4.0 * um, 8.0 * um};
  for (const Sense sense : {Sense::counter_clockwise, Sense::clockwise}) {
    const auto glitches = [&](double theta) {
      double sum = 0.0;
      for (int q = 0; q < 4; ++q) {
        const double phi = behind(theta, q * kTurn / 4, sense) / deg;
        if (phi > 0.0 && phi < 4.0) sum += height[q] * (1.0 - std::abs(phi - 2.0) / 2.0);
      }
      return sum;
    };
    const CircularTurn turn = evaluate_turn(radial_turn(glitches, sense), kNominal);
    const double shift = (turn.least_squares.centre - kNominal.centre).norm();
    EXPECT_GT(shift, 0.05 * um) << "spikes of different heights shift the centre";
    for (std::size_t q = 0; q < 4; ++q) {
      const Reversal& reversal = turn.reversals[q];
      EXPECT_EQ(reversal.axis, q % 2);
      EXPECT_NEAR(reversal.theta, static_cast<double>(q) * kTurn / 4, 1e-15);
      // the lines follow the circle that the shift tilts but for its curvature in the window
      EXPECT_NEAR(reversal.spike, height[q], 0.1 * shift) << q;
      EXPECT_NEAR(behind(reversal.spike_theta, reversal.theta, sense), 2.0 * deg, 0.11 * deg);
      EXPECT_NEAR(reversal.step, 0.0, 0.1 * shift);
    }
    EXPECT_NEAR(turn.F_max - turn.F_min, turn.G_least_squares, kRounding);
    EXPECT_LE(turn.G, turn.G_least_squares);
  }
}

// Backlash: the axis stays behind by a constant on each side. A step is no spike.
TEST(CircularTest, TellsBacklashFromSpikes) {
  const auto lost =
      [](double theta) {  // X moves towards minus: above the centre, counter-clockwise
        return Vector2d(std::sin(theta) > 0.0 ? 3.0 * um : -3.0 * um, 0.0);
      };
  const CircularTurn turn = evaluate_turn(turn_of(lost), kNominal);
  constexpr double kBent = 0.05;  // dr = dx cos theta: the curve bends where the lines are straight
  EXPECT_NEAR(turn.reversals[0].step, 6.0 * um, kBent * 6.0 * um);
  EXPECT_NEAR(turn.reversals[2].step, 6.0 * um, kBent * 6.0 * um);
  for (const Reversal& reversal : turn.reversals) {
    EXPECT_NEAR(reversal.spike, 0.0, kBent * 6.0 * um) << reversal.theta / deg;
  }
}

// Scales of the axes that differ: an ellipse along the axes, which the lines cannot follow.
TEST(CircularTest, LeavesAFifthOfAnEllipseAlongTheAxesInTheSpike) {
  const CircularTurn turn = evaluate_turn(
      radial_turn([](double theta) { return 5.0 * um * std::cos(2.0 * theta); }), kNominal);
  for (const Reversal& reversal : turn.reversals) {
    const double left = (reversal.axis == 0 ? 1.0 : -1.0) * reversal.spike;
    EXPECT_NEAR(left, 0.215 * 5.0 * um, 0.015 * 5.0 * um);  // a point more or less in an arc counts
  }
}

// White noise of 1 um: mean values average it out, extremes are its extremes.
TEST(CircularTest, AveragesNoiseInMeanValuesOnly) {
  boost::random::mt19937 random(7);
  boost::random::normal_distribution<double> noise(0.0, 1.0 * um);
  const auto noisy = [&](double) { return noise(random) - 2.0 * um; };
  const Points ccw = radial_turn(noisy), cw = radial_turn(noisy, Sense::clockwise);
  const CircularTurn turn = evaluate_turn(ccw, kNominal);
  const double of_mean = 1.0 * um / std::sqrt(3600.0);
  EXPECT_NEAR(turn.least_squares.radius, kNominal.radius - 2.0 * um, 4.0 * of_mean);
  EXPECT_NEAR((turn.least_squares.centre - kNominal.centre).norm(), 0.0, 4.0 * 2.0 * of_mean);
  EXPECT_NEAR(turn.squareness * kNominal.radius, 0.0, 4.0 * 2.0 * std::sqrt(2.0) * of_mean);
  EXPECT_GT(turn.G, 6.0 * um);
  EXPECT_LT(turn.G, 8.5 * um);
  const BidirectionalCircle both = evaluate_both(ccw, cw, kNominal);
  EXPECT_NEAR(both.D, 2.0 * um, 4.0 * of_mean);
  EXPECT_GE(both.G_b, std::max(turn.G, evaluate_turn(cw, kNominal).G));
}

TEST(CircularTest, WantsOneTurn) {
  const auto circle = [](double) { return 0.0; };
  EXPECT_EQ(why_no_turn(radial_turn(circle), kNominal), std::nullopt);
  EXPECT_EQ(why_no_turn(radial_turn(circle, Sense::clockwise, 358.2), kNominal), std::nullopt);
  EXPECT_EQ(why_no_turn(radial_turn(circle, Sense::clockwise, 362.0), kNominal), std::nullopt);
  EXPECT_EQ(why_no_turn(radial_turn(circle, Sense::clockwise, 358.0), kNominal),
            "covers 357.9 deg of the circle; must be a full circle, 360 deg");
  EXPECT_EQ(why_no_turn(radial_turn(circle, Sense::clockwise, 180.1), kNominal),
            "covers 180 deg of the circle; must be a full circle, 360 deg");
  EXPECT_EQ(why_no_turn(radial_turn(circle, Sense::counter_clockwise, 720.1), kNominal),
            "covers 720 deg of the circle; must be a full circle, 360 deg");
  EXPECT_EQ(why_no_turn({}, kNominal),
            "covers 0 deg of the circle; must be a full circle, 360 deg");
}

TEST(CircularTest, WantsPointsCloseTogetherAndOnTheCircle) {
  Points coarse;
  for (int i = 0; i < 120; ++i) coarse.push_back(radial_turn([](double) { return 0.0; })[30 * i]);
  EXPECT_EQ(why_no_turn(coarse, kNominal), "has samples 3 deg apart; must be <= 2 deg");
  EXPECT_EQ(why_no_turn(radial_turn([](double) { return -6.0 * mm; }), kNominal),
            "deviates from the circle of radius 50 mm by 6 mm");
}

}  // namespace
}  // namespace servomill::sim::metrology::circular_test_test
