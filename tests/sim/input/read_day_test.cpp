// Day of a machine that warms up, as a scenario has it.
#include "sim/input/read_day.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "sim/model/working_day.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::input::read_day_test {
namespace {

const std::string kHeat =
    "[machine_override.heat]\nsurroundings = { room = {} }\n[machine_override.heat.body.head]\n"
    "capacity_J_per_K = 500.0\nconductance_W_per_K = { room = 4.0 }\n";
const std::string kPlace =
    "[[day.place]]\nname = \"datum\"\nat = { X_mm = 10.0, Y_mm = 0.0, Z_mm = 100.0, B_deg = 0.0, "
    "C_deg = 90.0 }\ntool_length_mm = 120.0\n";

model::Scenario read(const std::string& day, const std::string& heat = kHeat) {
  return small_scenario("G0 X1\nM2\n", "[[case]]\nname = \"one\"\n[day]\n" + day + heat);
}

std::string fault_of(const std::string& day, const std::string& heat = kHeat) {
  try {
    read(day, heat);
  } catch (const InputError& error) {
    std::string all;
    for (const Fault& fault : error.faults()) all += fault.message + "\n";
    return all;
  }
  return "none";
}

std::string phase(const std::string& keys) { return "[[day.phase]]\n" + keys + "\n"; }

TEST(ReadDay, HasSiUnits) {
  const model::WorkingDay day =
      *read("sample_min = 0.5\n" + kPlace +
            phase("activity = \"spindle\"\nduration_min = 15\nspeed_rpm = 60") +
            phase("activity = \"probe\"\nplace = \"datum\"") +
            phase("activity = \"program\"\ncycles = 14"))
           .day;
  EXPECT_NEAR(day.sample, 30.0, 1e-12);
  EXPECT_NEAR(day.places.at(0).Q[0], 10 * mm, 1e-15);
  EXPECT_NEAR(day.places.at(0).Q[4], 90 * deg, 1e-15);
  EXPECT_NEAR(day.places.at(0).p_ST.z(), -120 * mm, 1e-15);
  ASSERT_EQ(day.phases.size(), 3U);
  EXPECT_NEAR(day.phases[0].duration, 900.0, 1e-12);
  EXPECT_NEAR(day.phases[0].spindle, 60 * rpm, 1e-12);
  EXPECT_EQ(day.phases[2].cycles, 14);
}

TEST(ReadDay, WantsAMachineWithHeat) {
  EXPECT_EQ(
      fault_of(kPlace + phase("activity = \"idle\"\nduration_min = 1"), ""),
      "day: needs [heat] in the machine of the scenario; that of a case alone is not enough\n");
}

// Every axis: where one of them is, nobody may guess.
TEST(ReadDay, WantsPlacesWithinTheTravelOfEveryAxis) {
  const std::string idle = phase("activity = \"idle\"\nduration_min = 1");
  EXPECT_EQ(fault_of("[[day.place]]\nname = \"a\"\nat = { X_mm = 0.0, Y_mm = 0.0, Z_mm = 500.0, "
                     "C_deg = 0.0 }\ntool_length_mm = 120.0\n" +
                     idle),
            "day.place[0].at.B_deg is missing\n"
            "day.place[0].at.Z_mm = 500.0; must be within the travel, -100 to 400\n");
  EXPECT_EQ(fault_of(kPlace + kPlace + idle), "day.place[1].name = \"datum\"; appears twice\n");
}

TEST(ReadDay, WantsKnownActivitiesAndPlaces) {
  EXPECT_EQ(fault_of(kPlace + phase("activity = \"lunch\"\nduration_min = 1")),
            "day.phase[0].activity = \"lunch\"; must be one of idle, spindle, program, probe\n");
  EXPECT_EQ(fault_of(kPlace + phase("activity = \"probe\"\nplace = \"datu\"")),
            "day.phase[0].place = \"datu\"; no such place; did you mean 'datum'?\n");
  EXPECT_EQ(fault_of(kPlace + phase("activity = \"idle\"\ncycles = 3")),
            "day.phase[0].duration_min is missing\nday.phase[0].cycles is not known\n");
}

}  // namespace
}  // namespace servomill::sim::input::read_day_test
