/// Life of an instance: messages and times. tests/fmu holds its behaviour to the rules of FMI.
#include "sim/fmu/axis_instance.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "tests/sim/fmu/exported.h"

namespace servomill::sim::fmu::axis_instance_test {
namespace {

class AxisInstances : public testing::Test {
 protected:
  AxisInstance instance() {
    return {std::make_shared<const AxisConstants>(exported_axis(rich_scenario(), 1, 0)),
            [this](Severity, const std::string& message) { message_ = message; }};
  }
  AxisInstance stepping(double start = 0.0) {
    AxisInstance axis = instance();
    EXPECT_TRUE(axis.set_up(start) && axis.enter_initialization() && axis.exit_initialization());
    return axis;
  }
  double value(AxisInstance& axis, const char* name) {
    double value = 0.0;
    EXPECT_TRUE(axis.get(reference_of(name), value)) << message_;
    return value;
  }
  std::string message_;
};

TEST_F(AxisInstances, NameTheRuleOfARefusal) {
  AxisInstance axis = instance();
  double value = 0.0;
  EXPECT_FALSE(axis.get(reference_of("position"), value));
  EXPECT_EQ(message_, "'position' has no value before initialization");
  EXPECT_FALSE(axis.set(reference_of("position"), 0.0));
  EXPECT_EQ(message_, "'position' cannot be set");
  EXPECT_FALSE(axis.get(77, value));
  EXPECT_EQ(message_, "no variable has the value reference 77");
  EXPECT_FALSE(axis.exit_initialization());
  EXPECT_EQ(message_, "no initialization to be ended");
  EXPECT_TRUE(axis.set(reference_of("friction_factor"), 0.0) && axis.enter_initialization());
  EXPECT_FALSE(axis.exit_initialization());
  EXPECT_EQ(message_, "friction_factor = 0; must be > 0");
}

TEST_F(AxisInstances, NameTheTimesOfAWrongStep) {
  AxisInstance axis = stepping(2.0);
  EXPECT_EQ(message_, "axis Y is at rest at 0 m");
  EXPECT_EQ(axis.step(2.1, 1 * ms), Step::refused);
  EXPECT_EQ(message_, "a step from 2.1 s: the last communication point is 2 s");
  EXPECT_EQ(axis.step(2.0, 0.0), Step::refused);
  EXPECT_EQ(message_, "a step of 0 s; must be > 0, and end within 1e+14 base periods");
}

TEST_F(AxisInstances, StopWhereTheNcStopsTheMachine) {
  AxisInstance axis = stepping();
  EXPECT_EQ(axis.step(0.0, 1 * ms), Step::done);
  EXPECT_TRUE(axis.set(reference_of("position_setpoint"), 20 * mm));
  EXPECT_EQ(axis.step(1 * ms, 1 * ms), Step::stopped);
  EXPECT_EQ(message_, "axis Y: following error beyond 10 mm at 0.0010 s");
  EXPECT_EQ(axis.time(), 1 * ms);
  EXPECT_TRUE(axis.is_stopped());
}

// Steps of 10.4 us: the ticks of 10 us that have passed move the axis, the time is the importer's.
TEST_F(AxisInstances, CountTicksThatHavePassed) {
  AxisInstance axis = stepping(), whole = stepping();
  const std::uint32_t setpoint = reference_of("position_setpoint");
  EXPECT_TRUE(axis.set(setpoint, 0.1 * mm) && whole.set(setpoint, 0.1 * mm));
  for (int n = 0; n < 100; ++n) {
    EXPECT_EQ(axis.step(10.4e-6 * n, 10.4e-6 * (n + 1) - 10.4e-6 * n), Step::done);
  }
  EXPECT_EQ(whole.step(0.0, 1.04 * ms), Step::done);
  EXPECT_NEAR(value(axis, "time"), 1.04 * ms, 1e-12);
  EXPECT_EQ(value(axis, "position"), value(whole, "position"));
  EXPECT_GT(value(axis, "position"), 0.0);
}

TEST_F(AxisInstances, RefuseAStateOfAnotherAxis) {
  AxisInstance axis = stepping();
  const std::string bytes = axis.bytes_of(axis.memory());
  EXPECT_TRUE(axis.memory_from(bytes).has_value());
  AxisInstance other{std::make_shared<const AxisConstants>(exported_axis(rich_scenario(), 0, 0)),
                     [this](Severity, const std::string& message) { message_ = message; }};
  EXPECT_FALSE(other.memory_from(bytes).has_value());
  EXPECT_EQ(message_, "the serialized state is damaged, or of another axis or version");
}

TEST(AxisVariables, HaveUnitsOfTheirAxis) {
  const AxisConstants linear = exported_axis(rich_scenario(), 0, 0),
                      rotary = exported_axis(rich_scenario(), 3, 0);
  AxisConstants motor = linear;
  motor.drive().kind = plant::DriveKind::direct;
  EXPECT_EQ(unit_of(Kind::position, linear).name, "m");
  EXPECT_EQ(unit_of(Kind::position, rotary).name, "rad");
  EXPECT_EQ(unit_of(Kind::force, rotary).name, "N.m");
  EXPECT_EQ(unit_of(Kind::velocity_gain, linear).name, "N.m.s/rad");
  EXPECT_EQ(unit_of(Kind::velocity_gain, motor).name, "N.s/m");
  EXPECT_EQ(unit_of(Kind::motor_inertia, motor).name, "kg");
}

TEST(AxisVariables, LeaveAnAxisAsItIsAtTheirStartValues) {
  const AxisConstants axis = exported_axis(rich_scenario(), 1, 0);
  std::string fault;
  EXPECT_EQ(text_of(with_parameters(axis, start_values(axis), fault)), text_of(axis));
  EXPECT_EQ(fault, "");
}

}  // namespace
}  // namespace servomill::sim::fmu::axis_instance_test
