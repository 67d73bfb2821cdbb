/// The tick of the structure allocates nothing.
#include <gtest/gtest.h>

#include "plant/structure/inertial_deflection.h"
#include "plant/vocabulary/units.h"
#include "tests/counting_new.h"

namespace servomill::plant {
namespace {

TEST(InertialDeflection, takes_nothing_from_the_heap) {
  InertialDeflection structure(
      {{.direction = 0, .joint = 0, .gain = 1.0 * um, .mode = {377.0, 0.05}},
       {.direction = 1, .joint = 0, .gain = 0.2 * um}},
      10e-6, {10});
  structure.start(Joints::Zero());
  const std::size_t before = allocations;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int n = 1; n < 100; ++n) {
    structure.advance(Joints::Constant(1e-3 * n), Joints::Constant(1e-2), 10);
    sum += structure.at(Joints::Constant(0.1));
  }
  EXPECT_EQ(allocations, before);
  EXPECT_NE(sum.x(), 0.0);
}

}  // namespace
}  // namespace servomill::plant
