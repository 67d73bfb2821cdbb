/// Modes of the tool point, as machine files describe them.
#include "sim/input/read_tool_point_modes.h"

#include <gtest/gtest.h>

#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::input::read_tool_point_modes_test {
namespace {

std::vector<plant::ToolPointMode> read(const std::string& modes) {
  return small_scenario("M30\n", "[machine_override]\ntool_point_mode = [" + modes +
                                     "]\n[[case]]\nname = \"one\"\n")
      .machine.tool_point_modes;
}

std::string refusal(const std::string& modes) {
  try {
    read(modes);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("error: ") + 7);
  }
  return "taken";
}

TEST(ReadToolPointModes, absent_ones_do_not_vibrate) {
  EXPECT_TRUE(
      small_scenario("M30\n", "[[case]]\nname = \"one\"\n").machine.tool_point_modes.empty());
}

TEST(ReadToolPointModes, reads_directions_of_any_length) {
  const auto modes = read(
      "{ direction = [0, 3, 0], stiffness = \"20 N/um\", frequency_Hz = 500.0, damping = 0.03 }, "
      "{ direction = [3, 0, -4], stiffness = 3e7, frequency_Hz = 800.0, damping = 0.02 }");
  ASSERT_EQ(modes.size(), 2U);
  EXPECT_EQ(modes[0].direction, Eigen::Vector3d::UnitY());
  EXPECT_DOUBLE_EQ(modes[0].stiffness, 20e6);
  EXPECT_DOUBLE_EQ(modes[0].mode.w, 2.0 * std::numbers::pi * 500.0);
  EXPECT_DOUBLE_EQ(modes[0].mode.zeta, 0.03);
  EXPECT_LT((modes[1].direction - Eigen::Vector3d(0.6, 0.0, -0.8)).norm(), 1e-15);
}

TEST(ReadToolPointModes, refuses_what_no_mode_has) {
  const std::string rest = ", frequency_Hz = 500.0, damping = 0.03 }";
  const std::string path = "machine.tool_point_mode[0].";
  EXPECT_EQ(refusal("{ direction = [0, 0, 0], stiffness = 2e7" + rest),
            path + "direction = [0, 0, 0]; must be [x, y, z], not all 0; the length is irrelevant");
  EXPECT_EQ(refusal("{ direction = [0, 1], stiffness = 2e7" + rest),
            path + "direction = [0, 1]; must be [x, y, z]");
  EXPECT_EQ(refusal("{ direction = [0, 1, 0], stiffness = 0.0" + rest),
            path + "stiffness = 0.0; must be > 0");
  EXPECT_EQ(
      refusal("{ direction = [0, 1, 0], stiffness = 2e7, frequency_Hz = 500.0, damping = 1 }"),
      path + "damping = 1; must be > 0 and < 1");
}

}  // namespace
}  // namespace servomill::sim::input::read_tool_point_modes_test
