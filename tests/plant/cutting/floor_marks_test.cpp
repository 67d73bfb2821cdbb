/// Marks of single teeth on floors, against their closed forms.
#include "plant/cutting/floor_marks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "plant/vocabulary/units.h"

namespace servomill::plant::floor_marks_test {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 4 * mm, kFeed = 0.073 * mm;  // a tooth
constexpr int kTeeth = 4;

Cutter cutter(double corner, double runout = 0.0) {
  return {.radius = kRadius,
          .corner_radius = corner,
          .length = 30 * mm,
          .teeth = kTeeth,
          .runout = runout};
}

// Along +X on a floor at Z = 0, the axis leaning by an angle towards the feed: the front of the
// bottom is lower. The cutter turns by 8 deg from one position to the next.
struct Pass {
  std::vector<CutterPosition> positions;
  std::vector<double> angles;
  double lean, sense;

  explicit Pass(double lean_in = 0.0, double sense_in = 1.0) : lean(lean_in), sense(sense_in) {
    constexpr double kRows = 45.0;  // of a turn
    for (int i = 0; i <= static_cast<int>(50.0 * kRows); ++i) {
      const double turns = i / kRows;
      const Vector3d axis(-std::sin(lean), 0.0, std::cos(lean));
      positions.push_back({{turns * kTeeth * kFeed - 8 * mm, 0.0, 0.0}, axis});
      angles.push_back(sense * 2.0 * kPi * turns);
    }
  }

  // Material left above Z = height at x, y.
  double at(const Cutter& of, double x, double y = 0.0, double height = 0.0) const {
    const auto nearest = std::min_element(
        positions.begin(), positions.end(), [&](const CutterPosition& a, const CutterPosition& b) {
          return std::abs(a.tip.x() - x) < std::abs(b.tip.x() - x);
        });
    return floor_mark(of, {positions, angles}, {{x, y, height}, Vector3d::UnitZ()},
                      static_cast<std::size_t>(nearest - positions.begin()))
        .value();
  }

  // At equal distances over a length.
  std::vector<double> along(const Cutter& of, double length, double y = 0.0,
                            double height = 0.0) const {
    constexpr int kPoints = 400;
    std::vector<double> out;
    for (int i = 0; i < kPoints; ++i) {
      out.push_back(at(of, length * (i + 0.5) / kPoints, y, height));
    }
    return out;
  }
};

double range(const std::vector<double>& d) {
  return *std::max_element(d.begin(), d.end()) - *std::min_element(d.begin(), d.end());
}

// A ball leaves arcs z = u^2 / (2 r) of the section that it has at y, over a feed per tooth; teeth
// that come against the feed meet a point more often.
TEST(FloorMarks, of_a_ball_are_arcs_of_its_radius) {
  for (const double sense : {1.0, -1.0}) {
    for (const double y : {2 * mm, -1 * mm}) {
      const double r = std::sqrt(kRadius * kRadius - y * y), v = kTeeth * kFeed / (2.0 * kPi);
      const double c = kFeed / (1.0 + sense * v / y);
      const double height = c * c / (8.0 * r);
      const Pass pass(0.0, sense);
      const std::vector<double> d = pass.along(cutter(kRadius), 4.0 * kFeed, y, kRadius - r);
      EXPECT_NEAR(range(d), height, 0.02 * height) << sense << " " << y;
      EXPECT_NEAR(*std::min_element(d.begin(), d.end()), 0.0, 0.01 * height);
    }
  }
}

TEST(FloorMarks, of_a_ball_are_none_on_the_track_of_its_tip) {
  for (const double d : Pass().along(cutter(kRadius), 2.0 * kFeed)) EXPECT_LT(std::abs(d), 1 * nm);
}

// A corner that leans into the feed cuts with its own radius: c^2 / (8 r).
TEST(FloorMarks, of_a_leaning_corner_are_arcs_of_its_radius) {
  const double r = 0.5 * mm, lean = 0.15;  // lowest on the corner: r sin(lean) = 75 um > c / 2
  const Cutter bull = cutter(r);
  // lowest point of the corner below the tip
  const double floor = -(kRadius - r) * std::sin(lean) + r * (std::cos(lean) - 1.0);
  const double height = kFeed * kFeed / (8.0 * r);
  const std::vector<double> d = Pass(lean).along(bull, 4.0 * kFeed, 0.0, floor);
  EXPECT_NEAR(range(d), height, 0.02 * height) << "1.33 um";
  EXPECT_NEAR(*std::min_element(d.begin(), d.end()), 0.0, 0.01 * height);
}

// A flat bottom that leans by theta leaves saw teeth, c tan(theta) high; teeth that run out more
// than the feed N c tan(theta).
TEST(FloorMarks, of_a_leaning_flat_bottom_are_saw_teeth) {
  const double lean = 1e-3;
  const double floor = -kRadius * std::sin(lean);
  for (const double y : {0.0, 1 * mm, -2 * mm}) {
    const std::vector<double> even = Pass(lean).along(cutter(0.0), 4.0 * kFeed, y, floor);
    EXPECT_NEAR(range(even), kFeed * std::tan(lean), 0.02 * kFeed * std::tan(lean)) << y;
  }
  const Cutter out = cutter(0.0, 0.5 * mm);
  const std::vector<double> one = Pass(lean).along(out, 4.0 * kFeed, 0.0, floor);
  EXPECT_NEAR(range(one), 4.0 * kFeed * std::tan(lean), 0.02 * 4.0 * kFeed * std::tan(lean));
  // they rise evenly: each tenth of the height has a tenth of the length
  std::vector<double> sorted = one;
  std::sort(sorted.begin(), sorted.end());
  const double middle = sorted[sorted.size() / 2], quarter = sorted[sorted.size() / 4];
  EXPECT_NEAR((middle - sorted.front()) / range(one), 0.5, 0.01);
  EXPECT_NEAR((quarter - sorted.front()) / range(one), 0.25, 0.01);
}

TEST(FloorMarks, of_a_flat_bottom_across_the_axis_are_none) {
  for (const double d : Pass().along(cutter(0.0, 10 * um), 4.0 * kFeed))
    EXPECT_LT(std::abs(d), 1e-15);
}

TEST(FloorMarks, are_not_beside_the_cutter) {
  const Pass pass;
  const ProbeTarget beside{{0.0, 1.01 * kRadius, 0.0}, Vector3d::UnitZ()};
  EXPECT_FALSE(floor_mark(cutter(0.0), {pass.positions, pass.angles}, beside, 1200));
  EXPECT_TRUE(is_floor(beside, pass.positions.front()));
  EXPECT_FALSE(is_floor({beside.point, Vector3d::UnitY()}, pass.positions.front()));
}

}  // namespace
}  // namespace servomill::plant::floor_marks_test
