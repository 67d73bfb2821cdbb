// Heat of a machine as a file has it.
#include "sim/input/read_heat.h"

#include <gtest/gtest.h>

#include "plant/heat/temperature.h"
#include "plant/vocabulary/units.h"
#include "sim/model/heat.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::input::read_heat_test {
namespace {

const std::string kBody =
    "[machine_override.heat.body.head]\ncapacity_J_per_K = 500.0\nconductance_W_per_K = { room = "
    "4.0 }\n";

model::Scenario read(const std::string& heat) {
  return small_scenario("G0 X1\nM2\n", "[[case]]\nname = \"one\"\n[machine_override.heat]\n" +
                                           heat + "[machine_override.heat.surroundings.room]\n");
}

std::string fault_of(const std::string& heat) {
  try {
    read(heat);
  } catch (const InputError& error) {
    std::string all;
    for (const Fault& fault : error.faults()) all += fault.message + "\n";
    return all;
  }
  return "none";
}

TEST(ReadHeat, HasSiUnits) {
  const model::Scenario scenario = read(
      "start_degC = 25.0\nclock_h = 6.0\n[machine_override.heat.surroundings.oil]\nmean_degC = "
      "22.0\namplitude_K = 0.5\nperiod_h = 1.0\nwarmest_at_h = 0.25\n" +
      kBody +
      "errors_per_K = { EZZ = { constant_um = 3.0 } }\n[machine_override.heat.source]\n"
      "a = { body = \"head\", kind = \"spindle\", speed_rpm = [0, 60], power_W = [0, 5] }\n"
      "b = { body = \"head\", kind = \"friction\", axis = \"C\", share = 0.25 }\n");
  const model::HeatSettings& heat = *scenario.machine.heat;
  EXPECT_NEAR(heat.reference, 293.15, 1e-12);
  EXPECT_NEAR(heat.start.at(0), 298.15, 1e-12);
  EXPECT_NEAR(heat.clock, 21600.0, 1e-9);
  ASSERT_EQ(heat.network.surroundings.size(), 2U);
  EXPECT_NEAR(heat.network.surroundings[0].temperature(900.0), 295.65, 1e-12);
  EXPECT_NEAR(heat.network.surface_links.at(0).conductance, 4.0, 1e-12);
  EXPECT_NEAR(heat.errors.at(0).per_kelvin.component(*plant::error_name_of("EZZ")).value(0.0),
              3 * um, 1e-18);
  ASSERT_EQ(heat.sources.size(), 2U);
  EXPECT_NEAR(heat.sources[0].spindle.s[1], 60 * rpm, 1e-12);
  EXPECT_EQ(heat.sources[1].joint, 4);
  EXPECT_EQ(heat.sources[1].kind, model::HeatKind::friction);
}

TEST(ReadHeat, RefusesNetworksThatAreNotPassiveOrNotConnected) {
  EXPECT_EQ(fault_of("[machine_override.heat.body.head]\ncapacity_J_per_K = 500.0\n"),
            "machine.heat: head must be connected with the surroundings, directly or through other "
            "bodies\n");
  EXPECT_EQ(fault_of("[machine_override.heat.body.head]\ncapacity_J_per_K = -1.0\n"
                     "conductance_W_per_K = { room = -4.0 }\n"),
            "machine.heat.body.head.capacity_J_per_K = -1.0; must be > 0\n"
            "machine.heat.body.head.conductance_W_per_K.room = -4.0; must be >= 0\n");
  EXPECT_EQ(
      fault_of("[machine_override.heat.body.head]\ncapacity_J_per_K = 5.0\n"
               "conductance_W_per_K = { rom = 4.0, head = 1.0 }\n"),
      "machine.heat.body.head.conductance_W_per_K.rom = 4.0; must be the name of a body or of "
      "surroundings: head, room\n"
      "machine.heat.body.head.conductance_W_per_K.head = 1.0; leads back to the same body\n");
}

TEST(ReadHeat, RefusesALinkInBothDirections) {
  EXPECT_EQ(fault_of(kBody + "[machine_override.heat.body.column]\ncapacity_J_per_K = 5.0\n"
                             "conductance_W_per_K = { head = 1.0 }\n"),
            "none");
  EXPECT_EQ(
      fault_of("[machine_override.heat.body.head]\ncapacity_J_per_K = 500.0\n"
               "conductance_W_per_K = { room = 4.0, column = 1.0 }\n"
               "[machine_override.heat.body.column]\ncapacity_J_per_K = 5.0\n"
               "conductance_W_per_K = { head = 1.0 }\n"),
      "machine.heat.body.column.conductance_W_per_K.head = 1.0; is linked to column there; one "
      "direction is enough\n");
}

TEST(ReadHeat, RefusesSourcesWithoutBodyOrAxis) {
  EXPECT_EQ(fault_of(kBody + "[machine_override.heat.source]\na = { body = \"column\", kind = "
                             "\"motor\", axis = \"U\", resistance = 1.0 }\n"),
            "machine.heat.source.a.body = \"column\"; no such body; known are: head\n"
            "machine.heat.source.a.axis = \"U\"; must be an axis of the machine: X, Y, Z, B, C\n");
  EXPECT_EQ(fault_of(kBody + "[machine_override.heat.source]\na = { body = \"head\", kind = "
                             "\"spindle\", speed_rpm = [100, 50], power_W = [1, 2] }\n"),
            "machine.heat.source.a.speed_rpm = [100, 50]; must have at least two speeds, rising "
            "from 0\n");
  EXPECT_EQ(fault_of(kBody + "[machine_override.heat.source]\na = { body = \"head\", kind = "
                             "\"spindle\", speed_rpm = [0, 50], power_W = [1] }\n"),
            "machine.heat.source.a.power_W = [1]; has 1 powers for 2 speeds; must have one for "
            "each\n");
  EXPECT_EQ(fault_of(kBody + "[machine_override.heat.source]\na = { body = \"head\", kind = "
                             "\"fire\", power_W = 3.0 }\n"),
            "machine.heat.source.a.kind = \"fire\"; must be one of constant, spindle, motor, "
            "friction, cutting\n");
}

TEST(ReadHeat, RefusesMoreThanTheWholeCuttingPower) {
  const auto shares = [](const std::string& a, const std::string& b) {
    return kBody + "[machine_override.heat.source]\na = { body = \"head\", kind = \"cutting\", " +
           a + " }\nb = { body = \"head\", kind = \"cutting\", " + b + " }\n";
  };
  EXPECT_EQ(fault_of(shares("share = 0.4", "share = 0.6")), "none");
  EXPECT_EQ(fault_of(shares("share = 0.5", "share = 0.6")),
            "machine.heat.source: shares of the cutting power add up to 1.1; must not exceed 1\n");
  EXPECT_EQ(fault_of(shares("share = 0.5", "axis = \"X\"")),
            "machine.heat.source.b.share is missing\nmachine.heat.source.b.axis is not known\n");
}

TEST(ReadHeat, ReadsThePartThatGrows) {
  const std::string part = kBody + "[machine_override.heat.part]\n";
  const model::Scenario scenario = read(
      part + "body = \"head\"\nexpansion = \"23.5 um/m/K\"\nfixed_at_mm = [10.0, 0.0, -5.0]\n");
  const model::PartExpansion& read = scenario.machine.heat->part.value();
  EXPECT_NEAR(read.expansion, 23.5e-6, 1e-18);
  EXPECT_TRUE(read.fixed.isApprox(Eigen::Vector3d(10e-3, 0.0, -5e-3)));
  EXPECT_EQ(fault_of(part + "body = \"vice\"\nexpansion = -1e-6\nfixed_at_mm = [1.0]\n"),
            "machine.heat.part.body = \"vice\"; no such body; known are: head\n"
            "machine.heat.part.expansion = -1e-6; must be >= 0 and <= 0.0002 1/K\n"
            "machine.heat.part.fixed_at_mm = [1.0]; must be three coordinates, X, Y, Z of the "
            "workpiece\n");
}

TEST(ReadHeat, RefusesTemperaturesBeyondTheLimits) {
  EXPECT_EQ(fault_of("start_degC = 120.0\n" + kBody),
            "machine.heat.start_degC = 120.0; must be within -10 to 100 degC\n");
  EXPECT_EQ(fault_of(kBody + "[machine_override.heat.surroundings.oven]\nmean_degC = 95.0\n"
                             "amplitude_K = 10.0\n"),
            "machine.heat.surroundings: oven: from 85 to 105 degC; must be within -10 to 100 "
            "degC\n");
}

TEST(ReadHeat, RefusesErrorsWithAReversal) {
  EXPECT_EQ(fault_of(kBody + "errors_per_K = { EXX = { reversal = { width_um = 1.0, distance_mm = "
                             "1.0 } } }\n"),
            "machine.heat.body.head.errors_per_K: errors that depend on the temperature must not "
            "have a reversal\n");
}

}  // namespace
}  // namespace servomill::sim::input::read_heat_test
