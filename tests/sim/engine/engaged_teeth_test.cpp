#include "sim/engine/engaged_teeth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::sim::engine::engaged_teeth_test {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kChip = 0.06 * mm;

const plant::CuttingCoefficients& steel() { return plant::find_material("42CrMo4")->typical; }

plant::Cutter one_tooth() { return {.radius = 4 * mm, .length = 30 * mm, .teeth = 1}; }

const plant::EngagedArc kSlot{.width = 2 * mm, .height = 1 * mm, .from = 0.0, .to = kPi};

plant::CutterFrame frame(const Vector3d& feed, const Vector3d& k, bool clockwise) {
  return plant::frame_of({{Vector3d::Zero(), k}, feed, clockwise});
}

TEST(EngagedTeeth, mean_over_a_turn_is_the_average_force_in_the_workpiece) {
  EngagedTeeth teeth(steel());
  plant::Cutter cutter{.radius = 4 * mm, .length = 30 * mm, .teeth = 3, .helix = 0.5};
  const plant::CutterFrame at = frame({0.6, 0.0, -0.8}, {0.8, 0.0, 0.6}, false);
  const int n = teeth.add(1, cutter, at, {&kSlot, 1}, -80.0);
  Vector3d mean = Vector3d::Zero();
  for (int i = 0; i < 50; ++i) {
    mean += teeth.force(n, 0.7 - 2.0 * kPi * i / 50, -2.0 * kPi / 50, kChip, 1.5) / 50.0;
  }
  const Vector3d F =
      at.axes * plant::average_force(steel(), 3, at.feed, {&kSlot, 1}).at(kChip, 1.5);
  EXPECT_LE((mean - F).norm(), 1e-9 * F.norm());
  EXPECT_EQ(teeth.passing_frequency(), 240.0);
}

// A tooth feels most where it points along the feed, whatever the direction of feed and rotation:
// the angle at which it does so is that of the spindle, not of the feed.
TEST(EngagedTeeth, tooth_is_where_the_angle_of_the_spindle_puts_it) {
  const Vector3d k = Vector3d::UnitZ();
  for (const bool clockwise : {true, false}) {
    for (int turned = 0; turned < 8; ++turned) {
      const double a = turned * 0.25 * kPi + 0.1;
      EngagedTeeth teeth(steel());
      const Vector3d feed(std::cos(a), std::sin(a), 0.0);
      const int n = teeth.add(1, one_tooth(), frame(feed, k, clockwise), {&kSlot, 1}, 80.0);
      const double step = (clockwise ? 1 : -1) * deg;
      double best = 0.0, at_best = 0.0;
      for (int i = 0; i < 360; ++i) {
        const double F = teeth.force(n, i * step, step, kChip, 0.0).norm();
        if (F > best) at_best = (i + 0.5) * step;
        best = std::max(best, F);
      }
      const auto across = plant::spindle_directions(k);
      const Vector3d tooth = std::sin(at_best) * across.col(0) + std::cos(at_best) * across.col(1);
      EXPECT_GE(tooth.dot(feed), std::cos(1 * deg)) << "feed at " << a << " " << clockwise;
    }
  }
}

TEST(EngagedTeeth, angles_are_counted_from_Y_of_the_workpiece_unless_the_axis_is_along_X) {
  EXPECT_EQ(plant::spindle_directions(Vector3d::UnitZ()).col(0), Vector3d::UnitX());
  EXPECT_EQ(plant::spindle_directions(Vector3d::UnitZ()).col(1), Vector3d::UnitY());
  EXPECT_EQ(plant::spindle_directions(Vector3d::UnitX()).col(0), Vector3d::UnitY());
  EXPECT_EQ(plant::spindle_directions(Vector3d::UnitX()).col(1), Vector3d::UnitZ());
}

}  // namespace
}  // namespace servomill::sim::engine::engaged_teeth_test
