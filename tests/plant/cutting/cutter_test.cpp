#include "plant/cutting/cutter.h"

#include <gmock/gmock.h>

#include <cmath>

namespace servomill::plant::cutter_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kExact = 1e-15;  // m, rounding

TEST(Cutter, envelope_of_a_flat_end_mill_is_a_cylinder) {
  const Cutter cutter{.radius = 4e-3, .length = 20e-3};
  EXPECT_TRUE(cutter.is_flat());
  EXPECT_EQ(cutter.radius_at(0.0), 4e-3);
  EXPECT_EQ(cutter.radius_at(20e-3), 4e-3);
}

TEST(Cutter, envelope_of_a_ball_end_mill_is_a_half_sphere_below_a_cylinder) {
  const Cutter cutter{.radius = 4e-3, .corner_radius = 4e-3, .length = 20e-3};
  EXPECT_TRUE(cutter.is_ball());
  EXPECT_EQ(cutter.radius_at(0.0), 0.0);
  EXPECT_NEAR(cutter.radius_at(1e-3), 1e-3 * std::sqrt(7.0), kExact);
  EXPECT_NEAR(cutter.radius_at(4e-3), 4e-3, kExact);
  EXPECT_EQ(cutter.radius_at(5e-3), 4e-3);
}

TEST(Cutter, envelope_of_a_bull_nose_begins_with_a_flat_disc) {
  const Cutter cutter{.radius = 4e-3, .corner_radius = 1e-3, .length = 20e-3};
  EXPECT_FALSE(cutter.is_flat() || cutter.is_ball());
  EXPECT_NEAR(cutter.radius_at(0.0), 3e-3, kExact);
  EXPECT_NEAR(cutter.radius_at(0.4e-3), 3.8e-3, kExact);
  EXPECT_NEAR(cutter.radius_at(1e-3), 4e-3, kExact);
}

TEST(Cutter, tells_every_value_that_no_cutter_has) {
  EXPECT_THAT(implausible({.radius = 4e-3, .corner_radius = 4e-3, .length = 5e-3}), IsEmpty());
  EXPECT_THAT(implausible({.radius = 4e-3, .corner_radius = 5e-3, .length = 5e-3, .teeth = 0}),
              ElementsAre("corner_radius must be <= radius", "length must be > corner_radius",
                          "teeth must be >= 1"));
  EXPECT_THAT(implausible({}), ElementsAre("radius must be > 0", "length must be > corner_radius"));
}

}  // namespace
}  // namespace servomill::plant::cutter_test
