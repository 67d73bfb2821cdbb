#include "sim/programs/named_axes.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace servomill::sim::programs::named_axes_test {
namespace {

struct Named {
  int code;
  std::string axes;
};

// Code and axes of each block but the last.
std::vector<Named> named(const std::string& program) {
  controllers::Interpreter interpreter(program + "M2\n", "p.ngc", {});
  std::vector<Named> out;
  while (const auto block = interpreter.next_block()) {
    Named& one = out.emplace_back();
    one.code = non_modal_code(*block);
    for (const Axis axis : kAllAxes) {
      if (names_axis(*block, axis)) one.axes += letter(axis);
    }
  }
  out.pop_back();
  return out;
}

TEST(NamedAxes, AreThoseWithAWord) {
  const std::vector<Named> blocks = named("G21 G90 G0 X1 Z2 C3\n\nG53 G0 Y0\nG92.1\n");
  ASSERT_EQ(blocks.size(), 4u);
  EXPECT_EQ(blocks[0].axes, "XZC");
  EXPECT_EQ(blocks[0].code, -1);
  EXPECT_EQ(blocks[1].axes, "");
  EXPECT_EQ(blocks[1].code, -1);
  EXPECT_EQ(blocks[2].axes, "Y");
  EXPECT_EQ(blocks[2].code, 530);
  EXPECT_EQ(blocks[3].axes, "");
  EXPECT_EQ(blocks[3].code, 921);
}

TEST(NamedAxes, APolarCoordinateNamesXAndY) {
  const std::vector<Named> blocks = named("G21 G90 G0 X1 Y1\nG0 @10 ^30 Z5\n");
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_EQ(blocks[1].axes, "XYZ");
}

}  // namespace
}  // namespace servomill::sim::programs::named_axes_test
