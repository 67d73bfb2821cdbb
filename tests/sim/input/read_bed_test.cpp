/// Bed under an axis, as machine files describe it.
#include "sim/input/read_bed.h"

#include <gtest/gtest.h>

#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::input::read_bed_test {
namespace {

model::Scenario read(const std::string& axis, const std::string& bed) {
  return small_scenario("M30\n", "[machine_override.axis." + axis + ".machine_bed]\n" + bed +
                                     "[[case]]\nname = \"one\"\n");
}

std::string refusal(const std::string& bed, const std::string& axis = "X") {
  try {
    read(axis, bed);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("error: ") + 7);
  }
  return "taken";
}

TEST(ReadBed, stands_still_by_default) {
  const model::Scenario none = small_scenario("M30\n", "[[case]]\nname = \"one\"\n");
  for (const auto& drive : none.machine.drives) EXPECT_FALSE(drive.on_bed());
}

TEST(ReadBed, reads_the_bed_of_one_direction) {
  const model::Scenario scenario =
      read("Y", "mass = \"6000 kg\"\nfrequency_Hz = 18\ndamping = 0.04\n");
  EXPECT_EQ(scenario.machine.drives[1].bed,
            (plant::MachineBed{6000.0, 2.0 * std::numbers::pi * 18.0, 0.04}));
  EXPECT_FALSE(scenario.machine.drives[0].on_bed());
}

TEST(ReadBed, refuses_beds_that_there_are_not) {
  EXPECT_EQ(refusal("mass = 0\nfrequency_Hz = 18.0\ndamping = 0.04\n"),
            "machine.axis.X.machine_bed.mass = 0; must be > 0");
  EXPECT_EQ(refusal("mass = -6000.0\nfrequency_Hz = 18.0\ndamping = 0.04\n"),
            "machine.axis.X.machine_bed.mass = -6000.0; must be > 0");
  EXPECT_EQ(refusal("mass = 6000.0\nfrequency_Hz = 0.0\ndamping = 0.04\n"),
            "machine.axis.X.machine_bed.frequency_Hz = 0.0; must be > 0");
  EXPECT_EQ(refusal("mass = 6000.0\nfrequency_Hz = 18.0\ndamping = 1.0\n"),
            "machine.axis.X.machine_bed.damping = 1.0; must be >= 0 and < 1");
  EXPECT_EQ(refusal("frequency_Hz = 18.0\ndamping = 0.04\n"),
            "machine.axis.X.machine_bed.mass is missing");
}

TEST(ReadBed, refuses_modes_above_what_the_base_period_resolves) {
  EXPECT_EQ(refusal("mass = 6000.0\nfrequency_Hz = 5001.0\ndamping = 0.04\n"),
            "machine.axis.X.machine_bed.frequency_Hz = 5001.0; must be <= 5000 Hz: 20 base periods "
            "of 10 us in each period of the mode; without machine_bed the bed is at rest");
  EXPECT_EQ(refusal("mass = 6000.0\nfrequency_Hz = 5000.0\ndamping = 0.04\n"), "taken");
}

TEST(ReadBed, refuses_rotary_axes) {
  EXPECT_EQ(refusal("mass = 6000.0\nfrequency_Hz = 18.0\ndamping = 0.04\n", "C"),
            "machine.axis.C.machine_bed = {...}; needs a linear axis, along which its drive pushes "
            "the bed "
            "back");
}

}  // namespace
}  // namespace servomill::sim::input::read_bed_test
