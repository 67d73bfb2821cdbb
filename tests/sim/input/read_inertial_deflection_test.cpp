/// Deflection under acceleration, as machine files describe it.
#include "sim/input/read_inertial_deflection.h"

#include <gtest/gtest.h>

#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::input::read_inertial_deflection_test {
namespace {

std::vector<plant::InertialCompliance> read(const std::string& pairs) {
  return small_scenario("M30\n", "[machine_override.inertial_deflection]\n" + pairs +
                                     "[[case]]\nname = \"one\"\n")
      .machine.inertial_compliances;
}

std::string refusal(const std::string& pairs) {
  try {
    read(pairs);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("error: ") + 7);
  }
  return "taken";
}

constexpr const char* kPath = "machine.inertial_deflection.";

TEST(ReadInertialDeflection, is_rigid_by_default) {
  EXPECT_TRUE(
      small_scenario("M30\n", "[[case]]\nname = \"one\"\n").machine.inertial_compliances.empty());
}

TEST(ReadInertialDeflection, reads_modes_and_static_pairs) {
  const auto pairs = read(
      "XX = { gain_um_per_m_s2 = 1.5, frequency_Hz = 60.0, damping = 0.05 }\n"
      "ZY = { gain_um_per_m_s2 = \"-0.25 um/m s^2\", along = \"X\", slope_um_per_m_s2_per_m = 0.5 "
      "}\n"
      "YC = { gain_um_per_rad_s2 = 0.1 }\n");
  ASSERT_EQ(pairs.size(), 3U);
  const plant::InertialCompliance xx{
      .direction = 0, .joint = 0, .gain = 1.5 * um, .mode = {2.0 * std::numbers::pi * 60.0, 0.05}};
  EXPECT_EQ(pairs[0].mode, xx.mode);
  EXPECT_DOUBLE_EQ(pairs[0].gain, xx.gain);
  EXPECT_EQ(pairs[1].direction, 2);
  EXPECT_EQ(pairs[1].joint, 1);
  EXPECT_DOUBLE_EQ(pairs[1].gain, -0.25 * um);
  EXPECT_DOUBLE_EQ(pairs[1].gain_slope, 0.5 * um);
  EXPECT_EQ(pairs[1].along, 0);
  EXPECT_TRUE(pairs[1].is_static());
  EXPECT_EQ(pairs[2].joint, 4);
  EXPECT_DOUBLE_EQ(pairs[2].gain, 0.1 * um);
}

TEST(ReadInertialDeflection, refuses_pairs_that_the_machine_does_not_have) {
  for (const std::string name : {"XA", "BX", "X", "XYZ", "E0"}) {
    EXPECT_EQ(refusal(name + " = { gain_um_per_m_s2 = 1.0 }\n"),
              kPath + name +
                  " = {...}; must be named after a direction (X, Y, Z) and the axis that "
                  "accelerates (X, Y, Z, B, C), such as YX");
  }
}

TEST(ReadInertialDeflection, refuses_modes_that_the_loops_do_not_resolve) {
  EXPECT_EQ(refusal("XX = { gain_um_per_m_s2 = 1.0, frequency_Hz = 501.0, damping = 0.05 }\n"),
            std::string(kPath) +
                "XX.frequency_Hz = 501.0; must be <= 500 Hz: 20 of the shortest loop period of 100 "
                "us in each period of the mode; without frequency_Hz it is static");
  EXPECT_EQ(refusal("XX = { gain_um_per_m_s2 = 1.0, frequency_Hz = 0.0, damping = 0.05 }\n"),
            std::string(kPath) + "XX.frequency_Hz = 0.0; must be > 0");
}

TEST(ReadInertialDeflection, refuses_dampings_of_no_vibration) {
  for (const std::string damping : {"0.0", "1.0", "-0.05"}) {
    EXPECT_EQ(refusal("XX = { gain_um_per_m_s2 = 1.0, frequency_Hz = 60.0, damping = " + damping +
                      " }\n"),
              std::string(kPath) + "XX.damping = " + damping + "; must be > 0 and < 1");
  }
  EXPECT_EQ(refusal("XX = { gain_um_per_m_s2 = 1.0, frequency_Hz = 60.0 }\n"),
            std::string(kPath) + "XX.damping is missing");
  EXPECT_EQ(refusal("XX = { gain_um_per_m_s2 = 1.0, damping = 0.05 }\n"),
            std::string(kPath) +
                "XX.damping = 0.05; needs frequency_Hz: without it the deflection is static");
}

TEST(ReadInertialDeflection, refuses_gains_without_a_position_to_depend_on) {
  EXPECT_EQ(refusal("XX = { gain_um_per_m_s2 = 1.0, slope_um_per_m_s2_per_m = 0.5 }\n"),
            std::string(kPath) +
                "XX.slope_um_per_m_s2_per_m = 0.5; needs along, the linear axis on whose "
                "position it depends");
  EXPECT_EQ(
      refusal("XX = { gain_um_per_m_s2 = 1.0, slope_um_per_m_s2_per_m = 0.5, along = \"C\" }\n"),
      std::string(kPath) + "XX.along = \"C\"; must be a linear axis of the machine: X, Y, Z");
  EXPECT_EQ(refusal("XX = { gain_um_per_m_s2 = 1.0, along = \"Z\" }\n"),
            std::string(kPath) + "XX.slope_um_per_m_s2_per_m is missing");
}

TEST(ReadInertialDeflection, has_other_units_for_rotary_axes) {
  EXPECT_EQ(refusal("XC = { gain_um_per_rad_s2 = 1.0, gain_um_per_m_s2 = 1.0 }\n"),
            std::string(kPath) +
                "XC.gain_um_per_m_s2 is not known; did you mean 'gain_um_per_rad_s2', which is "
                "also given?");
  EXPECT_EQ(refusal("XX = { gain_um_per_m_s2 = \"1 um\" }\n").substr(0, 65),
            std::string(kPath) + "XX.gain_um_per_m_s2 = \"1 um\"; 'um' is");
}

}  // namespace
}  // namespace servomill::sim::input::read_inertial_deflection_test
