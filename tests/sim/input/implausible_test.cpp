#include "sim/input/implausible.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "sim/input/machine_description.h"
#include "sim/input/read_machine.h"

namespace servomill::sim::input::implausible_test {
namespace {

namespace fs = std::filesystem;

const fs::path kMachines = fs::path(SERVOMILL_SOURCE_DIR) / "scenarios/machines";

std::vector<std::string> values_with(const std::string& change) {
  const std::string file = (kMachines / "hsm600u.toml").string();
  return implausible_values(*read_machine_description(file, {change}).machine);
}

// A key with a bare number that was meant in another unit.
struct Slip {
  const char* change;
  const char* says;
};

TEST(ImplausibleValues, AreToldOfEveryQuantityOfAMachine) {
  for (const Slip& slip : {
           Slip{"axis.X.stiffness=180", "axis.X.stiffness = 180 N/m"},
           {"axis.X.damping=0.04", "axis.X.damping = 0.04 N s/m"},
           {"axis.X.structural_stiffness=50", "axis.X.structural_stiffness = 50 N/m"},
           {"axis.X.backlash=5", "axis.X.backlash = 5 m"},
           {"axis.X.moving_mass=750000", "axis.X.moving_mass = 750000 kg"},
           {"axis.X.lead_mm=0.02", "axis.X.lead_mm = 0.02 mm"},
           {"axis.X.motor_inertia=96", "axis.X.motor_inertia = 96 kg m^2"},
           {"axis.X.motor_viscous_friction=200", "axis.X.motor_viscous_friction = 200 Nms/rad"},
           {"axis.X.slide_viscous_friction=1e9", "axis.X.slide_viscous_friction = 1e+09 N s/m"},
           {"axis.X.Kt=1600", "axis.X.Kt = 1600 Nm/A"},
           {"axis.X.i_max_A=50000", "axis.X.i_max_A = 50000 A"},
           {"axis.X.v_max=40000", "axis.X.v_max = 40000 m/s"},
           {"axis.X.a_max=6000", "axis.X.a_max = 6000 m/s^2"},
           {"axis.X.j_max=5e6", "axis.X.j_max = 5e+06 m/s^3"},
           {"axis.X.velocity_command_max=40", "axis.X.velocity_command_max = 40 m/s"},
           {"axis.X.torque_max=1e6", "axis.X.torque_max = 1e+06 Nm"},
           {"axis.X.scale_step=19.5", "axis.X.scale_step = 19.5 m"},
           {"axis.X.scale={period=20}", "axis.X.scale.period = 20 m"},
           {"axis.X.motor_step=0.75", "axis.X.motor_step = 0.75 rad"},
           {"axis.X.Kv=0.08", "axis.X.Kv = 0.08 1/s"},
           {"axis.X.Kv=4", "axis.X.Kv = 4 1/s"},  // meant in m/min/mm: 67 1/s
           {"axis.X.velocity_bandwidth=2e5", "axis.X.velocity_bandwidth = 200000 rad/s"},
           {"axis.X.following_error_limit=10", "axis.X.following_error_limit = 10 m"},
           {"axis.X.standstill_limit=50", "axis.X.standstill_limit = 50 m"},
           {"axis.X.encoder_difference_limit=200", "axis.X.encoder_difference_limit = 200 m"},
           {"axis.X.backlash_compensation={width=5}", "axis.X.backlash_compensation.width = 5 m"},
           {"axis.X.screw={expansion=11.5}", "axis.X.screw.expansion = 11.5 1/K"},
           {"axis.X.screw={fixed_at=500}", "axis.X.screw.fixed_at = 500 m"},
           {"axis.C.moving_inertia=2e6", "axis.C.moving_inertia = 2e+06 kg m^2"},
           {"axis.C.v_max=36000", "axis.C.v_max = 36000 rad/s"},
           {"axis.C.scale_step=0.1", "axis.C.scale_step = 0.1 rad"},
           {"axis.C.following_error_limit=30", "axis.C.following_error_limit = 30 rad"},
       }) {
    const auto values = values_with(slip.change);
    ASSERT_EQ(values.size(), 1U) << slip.change;
    EXPECT_TRUE(
        values[0].starts_with(std::string(slip.says) + " is implausible for a machine tool; "))
        << values[0];
  }
}

TEST(ImplausibleValues, NameTheUnitOfBareNumbersAndOneThatIsMeant) {
  EXPECT_EQ(values_with("axis.X.motor_inertia=96"),
            std::vector<std::string>{
                "axis.X.motor_inertia = 96 kg m^2 is implausible for a machine tool; bare numbers "
                "are in kg m^2; for other units write, for example, \"0.0096 kg m^2\""});
}

TEST(ImplausibleValues, KnowTheFrictionOfADrive) {
  const std::string file = (kMachines / "hsm600u.toml").string();
  const auto values =
      implausible_values(*read_machine_description(file, {"friction_model=\"lugre\"",
                                                          "axis.X.friction.stribeck_velocity=2",
                                                          "axis.X.friction.bristle_stiffness=50"})
                              .machine);
  ASSERT_EQ(values.size(), 2U);
  EXPECT_TRUE(values[0].starts_with("axis.X.friction.stribeck_velocity = 2 m/s is implausible"));
  EXPECT_TRUE(values[1].starts_with("axis.X.friction.bristle_stiffness = 50 N/m is implausible"));
}

TEST(ImplausibleValues, AreInNoMachineThatComesWithServomill) {
  for (const auto& entry : fs::directory_iterator(kMachines)) {
    if (entry.path().extension() != ".toml") continue;
    const auto values =
        implausible_values(*read_machine_description(entry.path().string()).machine);
    EXPECT_TRUE(values.empty()) << entry.path() << ": " << values.front();
  }
}

}  // namespace
}  // namespace servomill::sim::input::implausible_test
