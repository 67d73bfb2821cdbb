/// Modes under forces of the cut, as machine files describe them.
#include "sim/input/read_structural_modes.h"

#include <gtest/gtest.h>

#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "sim/model/machine.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::input::read_structural_modes_test {
namespace {

std::vector<plant::StructuralMode> read(const std::string& modes) {
  return small_scenario("M30\n", "[machine_override]\nstructural_mode = [" + modes +
                                     "]\n[[case]]\nname = \"one\"\n")
      .machine.structural_modes;
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

constexpr const char* kPath = "machine.structural_mode[0].";

TEST(ReadStructuralModes, reads_static_ones_and_those_that_swing) {
  const auto modes = read(
      "{ direction = [3.0, 4.0, 0.0], stiffness = \"50 N/um\" },"
      "{ direction = [0.0, 0.0, 2.0], stiffness = 1e8, frequency_Hz = 60.0, damping = 0.05 }");
  ASSERT_EQ(modes.size(), 2U);
  EXPECT_TRUE(modes[0].direction.isApprox(Eigen::Vector3d(0.6, 0.8, 0.0)));
  EXPECT_DOUBLE_EQ(modes[0].compliance, 2e-8);
  EXPECT_TRUE(modes[0].is_static());
  EXPECT_EQ(modes[1].direction, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(modes[1].mode, (plant::Mode{2.0 * std::numbers::pi * 60.0, 0.05}));
  EXPECT_TRUE(
      small_scenario("M30\n", "[[case]]\nname = \"one\"\n").machine.structural_modes.empty());
}

TEST(ReadStructuralModes, refuses_directions_and_stiffnesses_of_none) {
  EXPECT_EQ(refusal("{ direction = [0.0, 0.0, 0.0], stiffness = 5e7 }"),
            std::string(kPath) +
                "direction = [0.0, 0.0, 0.0]; must be [x, y, z], not all 0; the length is "
                "irrelevant");
  EXPECT_EQ(refusal("{ direction = [1.0, 0.0], stiffness = 5e7 }"),
            std::string(kPath) + "direction = [1.0, 0.0]; must be [x, y, z]");
  EXPECT_EQ(refusal("{ direction = [1.0, 0.0, 0.0], stiffness = -5e7 }"),
            std::string(kPath) + "stiffness = -5e7; must be > 0");
}

TEST(ReadStructuralModes, refuses_modes_that_the_loops_do_not_resolve) {
  EXPECT_EQ(
      refusal("{ direction = [1.0, 0.0, 0.0], stiffness = 5e7, frequency_Hz = 5001.0, damping = "
              "0.05 }"),
      std::string(kPath) +
          "frequency_Hz = 5001.0; must be <= 5000 Hz: 20 of the base period of 10 us in each "
          "period "
          "of the mode; without frequency_Hz it is static");
  EXPECT_EQ(refusal("{ direction = [1.0, 0.0, 0.0], stiffness = 5e7, damping = 0.05 }"),
            std::string(kPath) +
                "damping = 0.05; needs frequency_Hz: without it the deflection is static");
}

}  // namespace
}  // namespace servomill::sim::input::read_structural_modes_test
