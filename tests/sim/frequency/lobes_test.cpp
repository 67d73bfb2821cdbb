#include "sim/frequency/lobes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::sim::frequency::lobes_test {
namespace {

using Eigen::Vector3d;

const plant::StructuralMode kMode{
    .direction = Vector3d::UnitY(), .compliance = 1.0 / 20e6, .mode = {3000.0, 0.03}};

TEST(Lobes, modes_are_seen_from_the_feed) {
  const plant::StructuralMode oblique{
      .direction = Vector3d(0.0, 0.6, 0.8), .compliance = 1.0 / 9e6, .mode = {4000.0, 0.02}};
  const plant::StructuralMode along{
      .direction = Vector3d::UnitZ(), .compliance = 1.0 / 9e6, .mode = {4000.0, 0.02}};
  const plant::StructuralMode all[] = {kMode, oblique, along};
  // feed along Y: e2 = k x e1 = -X
  const auto modes = modes_across(all, Vector3d::UnitY(), -Vector3d::UnitX());
  ASSERT_EQ(modes.size(), 2U) << "that along the tool is left out";
  EXPECT_EQ(modes[0].direction, Eigen::Vector2d::UnitX());
  EXPECT_DOUBLE_EQ(modes[0].stiffness, 20e6);
  EXPECT_DOUBLE_EQ(modes[1].stiffness, 9e6 / 0.36) << "share of the force and of displacement";
  EXPECT_DOUBLE_EQ(modes[1].frequency, 4000.0);
}

TEST(Lobes, are_those_of_their_speeds_for_any_number_of_threads) {
  LobesRequest request{.cut = {.coefficients = plant::find_material("42CrMo4")->typical,
                               .teeth = 4,
                               .from = 0.0,
                               .to = std::numbers::pi},
                       .modes = modes_across({&kMode, 1}, Vector3d::UnitX(), Vector3d::UnitY()),
                       .from = 60.0,
                       .to = 100.0,
                       .points = 5,
                       .deepest = 20 * mm};
  const auto one = stability_lobes(request, 1), three = stability_lobes(request, 3);
  ASSERT_EQ(one.size(), 5U);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_DOUBLE_EQ(one[i].turns, 60.0 + 10.0 * static_cast<double>(i));
    EXPECT_EQ(one[i].limit.depth, three[i].limit.depth);
    EXPECT_NEAR(one[i].limit.depth, one[i].zeroth_order.depth, 5e-3 * one[i].limit.depth);
  }
}

}  // namespace
}  // namespace servomill::sim::frequency::lobes_test
