#include "plant/cutting/tooth_marks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "plant/vocabulary/units.h"

namespace servomill::plant::tooth_marks_test {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 4 * mm, kFeed = 0.073 * mm;  // a tooth
constexpr double kExact = 1e-12;                        // m

Cutter end_mill(double runout = 0.0, double helix = 0.0) {
  return {.radius = kRadius, .length = 30 * mm, .teeth = 4, .helix = helix, .runout = runout};
}

// Along +X beside a wall at Y = 0, which is on the left of the feed: a clockwise cutter mills up.
struct Pass {
  std::vector<CutterPosition> positions;
  std::vector<double> angles;

  // @param sense  1 clockwise, -1 counter-clockwise
  // @param bend   m, towards the wall, a function of the angle
  explicit Pass(
      double sense, double rows_of_turn = 90.0,
      double (*bend)(double angle) = [](double) { return 0.0; }) {
    const double turns = 20.0;
    for (int i = 0; i <= static_cast<int>(turns * rows_of_turn); ++i) {
      const double angle = 2.0 * kPi * i / rows_of_turn;
      const double x = angle / (2.0 * kPi) * 4.0 * kFeed - 2 * mm;
      positions.push_back({{x, -kRadius + bend(angle), -5 * mm}, Vector3d::UnitZ()});
      angles.push_back(sense * angle);
    }
  }
  TurningPath path() const { return {positions, angles}; }
  // The position nearest to x.
  std::size_t near(double x) const {
    const auto nearest = std::min_element(
        positions.begin(), positions.end(), [&](const CutterPosition& a, const CutterPosition& b) {
          return std::abs(a.tip.x() - x) < std::abs(b.tip.x() - x);
        });
    return static_cast<std::size_t>(nearest - positions.begin());
  }

  // Material left above Y = 0, at x.
  double at(const Cutter& cutter, double x, double z = -1 * mm) const {
    return tooth_mark(cutter, path(), {{x, 0.0, z}, -Vector3d::UnitY()}, near(x)).value();
  }
};

// Range of the wall over a length about X0 that is a multiple of the waves.
struct Wave {
  double low = 1.0, high = -1.0, at_low = 0.0;
};
Wave wave(const Pass& pass, const Cutter& cutter, double length) {
  Wave out;
  constexpr int kPoints = 3650;
  for (int i = 0; i < kPoints; ++i) {
    const double x = length * (i + 0.5) / kPoints;
    const double d = pass.at(cutter, x);
    if (d < out.low) out.at_low = x;
    out.low = std::min(out.low, d);
    out.high = std::max(out.high, d);
  }
  return out;
}

double martellotti(double feed, double sign, double R = kRadius) {
  const double v = 4.0 * kFeed / (2.0 * kPi);
  return R * feed * feed / (8.0 * (R + sign * v) * (R + sign * v));
}

// The wall is on the left: up milling for a clockwise cutter, down milling for the other.
TEST(ToothMarks, of_equal_teeth_are_waves_of_one_feed_per_tooth_as_high_as_the_closed_form) {
  for (const double sense : {1.0, -1.0}) {
    const Pass pass(sense);
    const Wave w = wave(pass, end_mill(), kFeed);
    EXPECT_NEAR(w.low, 0.0, 1e-11);
    EXPECT_NEAR(w.high - w.low, martellotti(kFeed, sense), 2e-10) << "of 0.17 um";
    EXPECT_NEAR(w.high - w.low, kFeed * kFeed / (8.0 * kRadius), 0.03 * (w.high - w.low));
    for (const double x : {0.01 * mm, 0.05 * mm}) {
      EXPECT_NEAR(pass.at(end_mill(), x + kFeed), pass.at(end_mill(), x), kExact);
    }
  }
}

// 20 um of run-out: tooth 0 is 10 um farther out than tooth 2, and alone makes the surface, as its
// waves are 2.7 um high.
TEST(ToothMarks, of_a_tooth_that_runs_out_are_waves_of_a_turn) {
  const Pass pass(1.0);
  const Cutter cutter = end_mill(20 * um);
  const Wave w = wave(pass, cutter, 4.0 * kFeed);
  EXPECT_NEAR(w.low, -10 * um, 1e-11);
  EXPECT_NEAR(w.high - w.low, martellotti(4.0 * kFeed, 1.0, kRadius + 10 * um), 2e-9)
      << "of 2.6 um";
  const double x = 0.05 * mm;
  EXPECT_NEAR(pass.at(cutter, x + 4.0 * kFeed), pass.at(cutter, x), kExact);
  EXPECT_GT(std::abs(pass.at(cutter, x + kFeed) - pass.at(cutter, x)), 0.3 * um);
}

// 0.4 um of run-out: every tooth still cuts, waves of a turn and of a tooth.
TEST(ToothMarks, are_what_is_beyond_all_trochoids) {
  const Pass pass(1.0);
  Cutter cutter = end_mill(0.4 * um, 30 * deg);
  cutter.runout_direction = 0.7;
  const double z = -2.2 * mm, lag = 2.8 * mm * std::tan(cutter.helix) / kRadius;
  // the trochoids in small steps: material is left below all of them
  for (const double x : {0.0, 0.021 * mm, 0.1 * mm, 0.17 * mm, 0.25 * mm}) {
    double left = 1.0;
    for (int tooth = 0; tooth < 4; ++tooth) {
      const double R = kRadius + cutter.radius_offset(tooth);
      double x_before = 0.0, y_before = 0.0;
      constexpr int kSteps = 400000;
      for (int i = 0; i <= kSteps; ++i) {
        const double angle = 40.0 * kPi * i / kSteps;
        const double psi = angle + 0.5 * kPi * tooth - lag;
        const double x_now = angle / (2.0 * kPi) * 4.0 * kFeed - 2 * mm + R * std::sin(psi);
        const double y_now = -kRadius + R * std::cos(psi);
        if (i > 0 && y_now > -0.1 * mm && (x_before - x) * (x_now - x) <= 0.0) {
          const double share = (x - x_before) / (x_now - x_before);
          left = std::min(left, -(y_before + share * (y_now - y_before)));
        }
        x_before = x_now;
        y_before = y_now;
      }
    }
    EXPECT_NEAR(pass.at(cutter, x, z), left, 1e-10) << x;
  }
}

// Far more rows than teeth or less than one a tooth: the same surface, as the motion is even.
TEST(ToothMarks, do_not_depend_on_the_rows_of_an_even_motion) {
  const Pass fine(1.0, 90.0), coarse(1.0, 3.0);
  for (const double x : {0.01 * mm, 0.03 * mm, 0.06 * mm}) {
    EXPECT_NEAR(fine.at(end_mill(), x), coarse.at(end_mill(), x), 1e-11) << x;
  }
}

// A cutter that is bent away by 1 um where tooth 0 points at the wall and not at all half a turn
// later: each tooth leaves what the cutter is bent at its moment.
TEST(ToothMarks, are_made_where_the_cutter_is_at_the_moment_of_the_tooth) {
  const Pass straight(1.0, 360.0);
  const Pass bent(1.0, 360.0, [](double angle) { return -0.5 * um * (1.0 + std::cos(angle)); });
  // tooth 0 points at the wall where the angle is a whole turn: X = -2 mm + 4 feeds a turn
  const double of_tooth_0 = std::ceil(2 * mm / (4.0 * kFeed)) * 4.0 * kFeed - 2 * mm;
  for (int tooth = 0; tooth < 4; ++tooth) {
    // tooth j points at the wall j quarters of a turn before tooth 0
    const double x = of_tooth_0 - tooth * kFeed;
    const double moved = bent.at(end_mill(), x) - straight.at(end_mill(), x);
    const double expected = 0.5 * um * (1.0 + std::cos(0.5 * kPi * tooth));
    EXPECT_NEAR(moved, expected, 1e-10) << tooth;
  }
}

TEST(ToothMarks, are_none_beyond_the_flank_and_of_a_spindle_that_does_not_turn) {
  const Pass pass(1.0);
  const auto at = [&](const ProbeTarget& target) {
    return tooth_mark(end_mill(), pass.path(), target, pass.near(target.point.x())).has_value();
  };
  const Vector3d out = -Vector3d::UnitY();
  EXPECT_TRUE(at({{0.0, 0.0, -1 * mm}, out}));
  EXPECT_FALSE(at({{0.0, 0.0, -5.1 * mm}, out})) << "below the tip";
  EXPECT_FALSE(at({{0.0, 0.0, 25.1 * mm}, out})) << "above the flutes";
  EXPECT_FALSE(at({{0.0, 1 * mm, -1 * mm}, out})) << "away from the wall";
  EXPECT_FALSE(at({{0.0, 0.0, -1 * mm}, (out + 0.02 * Vector3d::UnitZ()).normalized()}));
  EXPECT_FALSE(at({{10 * mm, 0.0, -1 * mm}, out})) << "beyond the path";
  const std::vector<double> still(pass.angles.size(), 1.0);
  EXPECT_FALSE(
      tooth_mark(end_mill(), {pass.positions, still}, {{0.0, 0.0, -1 * mm}, out}, pass.near(0.0)));
}

// A tooth that is 40 um deeper in the wall leaves a circle of sqrt(2 R 40 um) = 0.57 mm to both
// sides, farther than three halves of a turn (0.44 mm).
TEST(ToothMarks, of_a_vibration_reach_as_far_as_its_swing) {
  constexpr double kDeep = 40 * um, kAway = 0.5 * mm;
  const Pass pass(1.0, 90.0,
                  [](double angle) { return std::abs(angle - 12.0 * kPi) < 0.3 ? kDeep : 0.0; });
  const double x = 6.0 * 4.0 * kFeed - 2 * mm + kAway;
  const auto mark = [&](double swing) {
    TurningPath path = pass.path();
    path.swing = swing;
    return tooth_mark(end_mill(), path, {{x, 0.0, -1 * mm}, -Vector3d::UnitY()}, pass.near(x))
        .value();
  };
  EXPECT_GT(mark(0.0), -1 * nm) << "marks of the feed alone";
  EXPECT_NEAR(mark(kDeep), -(kDeep - kAway * kAway / (2.0 * kRadius)), 1 * um);
}

}  // namespace
}  // namespace servomill::plant::tooth_marks_test
