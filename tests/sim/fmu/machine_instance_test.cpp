/// Several axes in one FMU.
#include "sim/fmu/machine_instance.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "sim/fmu/clocks.h"
#include "sim/model/scenario.h"
#include "tests/sim/fmu/exported.h"
#include "tests/sim/fmu/recorded.h"

namespace servomill::sim::fmu::machine_instance_test {
namespace {

const std::uint32_t kSetpoint = reference_of("position_setpoint"),
                    kPositionOf = reference_of("position");

MachineConstants axes_of(const std::vector<int>& joints) {
  const model::Scenario scenario = rich_scenario();
  MachineConstants out;
  for (const int joint : joints) out.axes.push_back(exported_axis(scenario, joint, 0));
  return out;
}

MachineInstance stepping(const std::vector<int>& joints) {
  MachineInstance machine(axes_of(joints), [](Severity, const std::string&) {});
  EXPECT_TRUE(machine.set_up(0.0) && machine.enter_initialization() &&
              machine.exit_initialization());
  return machine;
}

double value(MachineInstance& machine, std::uint32_t reference) {
  double value = 0.0;
  EXPECT_TRUE(machine.get(reference, value));
  return value;
}

// Steps to and fro from millisecond `from` on, axis by axis at another place.
void move(MachineInstance& machine, std::size_t count, int from, int to) {
  for (int n = from; n < to; ++n) {
    for (std::uint32_t axis = 0; axis < count; ++axis) {
      machine.set(axis * kAxisStride + kSetpoint, 1 * mm * std::sin(0.05 * n) * (1.0 + axis));
    }
    ASSERT_EQ(machine.step(n * ms, ms), Step::done);
  }
}

TEST(MachineInstance, GivesEachAxisTheBitsThatItHasAlone) {
  MachineInstance both = stepping({0, 1}), alone = stepping({0});
  move(both, 2, 0, 100);
  move(alone, 1, 0, 100);
  EXPECT_EQ(value(both, kPositionOf), value(alone, kPositionOf));
  EXPECT_NE(value(both, kPositionOf), value(both, kAxisStride + kPositionOf));
}

TEST(MachineInstance, StopsAllAxesWhereTheNcStopsTheFirst) {
  MachineInstance both = stepping({0, 1}), free = stepping({0});
  both.set(kSetpoint, 1 * mm);
  free.set(kSetpoint, 1 * mm);
  EXPECT_EQ(both.step(0.0, 1 * ms), Step::done);
  both.set(kAxisStride + kSetpoint, 20 * mm);  // of the other axis
  EXPECT_EQ(both.step(1 * ms, 10 * ms), Step::stopped);
  EXPECT_EQ(both.time(), 1 * ms);
  EXPECT_TRUE(both.is_stopped());
  EXPECT_EQ(free.step(0.0, 1 * ms), Step::done);
  EXPECT_EQ(value(both, kPositionOf), value(free, kPositionOf));
  EXPECT_EQ(both.step(1 * ms, 1 * ms), Step::refused);
}

// Both would be stopped within the step, Y later than X.
TEST(MachineInstance, SaysWhyTheFirstWasStoppedAndNoMore) {
  std::vector<std::string> said;
  MachineInstance both(axes_of({0, 1}), [&](Severity severity, const std::string& why) {
    if (severity == Severity::stop) said.push_back(why);
  });
  ASSERT_TRUE(both.set_up(0.0) && both.enter_initialization() && both.exit_initialization());
  move(both, 2, 0, 10);
  both.set(kSetpoint, 20 * mm);
  both.set(kAxisStride + kSetpoint, 4 * mm);
  EXPECT_EQ(both.step(10 * ms, 1.0), Step::stopped);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].substr(0, said[0].find(':')), "axis X");
  EXPECT_TRUE(both.is_stopped());
  const std::string bytes = both.bytes_of(both.memory());
  MachineInstance other = stepping({0, 1});
  ASSERT_TRUE(other.restore(*other.memory_from(bytes)));
  EXPECT_TRUE(other.is_stopped());
  EXPECT_EQ(other.step(10 * ms, 1 * ms), Step::refused);
}

TEST(MachineInstance, GoesOnFromBytes) {
  MachineInstance both = stepping({0, 1}), other = stepping({0, 1});
  move(both, 2, 0, 33);
  const std::string bytes = both.bytes_of(both.memory());
  move(both, 2, 33, 66);
  ASSERT_TRUE(other.restore(*other.memory_from(bytes)));
  move(other, 2, 33, 66);
  for (const std::uint32_t axis : {0U, kAxisStride}) {
    EXPECT_EQ(value(other, axis + kPositionOf), value(both, axis + kPositionOf));
  }
  EXPECT_FALSE(other.memory_from(bytes + "x").has_value());
  EXPECT_FALSE(stepping({1, 0}).memory_from(bytes).has_value());
}

TEST(MachineInstance, ReadsClocksInEventMode) {
  std::string message;
  MachineInstance machine(axes_of({1}), [&](Severity, const std::string& why) { message = why; });
  machine.use_events(true);
  bool ticks = false;
  EXPECT_FALSE(machine.ticks(kClockReference, ticks));
  EXPECT_EQ(message, "clocks are read in event mode");
  EXPECT_FALSE(machine.enter_event_mode());
  EXPECT_EQ(message, "event mode follows a step, of an instance that uses it");
  ASSERT_TRUE(machine.set_up(3.0) && machine.enter_initialization() &&
              machine.exit_initialization());
  EXPECT_TRUE(machine.ticks(kClockReference, ticks) && ticks);
  EXPECT_FALSE(machine.ticks(kClockReference + 3, ticks));
  EXPECT_EQ(message, "no clock has the value reference 2003");
  EXPECT_EQ(machine.step(3.0, 1 * ms), Step::refused);
  EXPECT_EQ(message, "no step in event mode");
  const std::string bytes = machine.bytes_of(machine.memory());
  EXPECT_TRUE(machine.enter_step_mode());
  EXPECT_EQ(machine.step(3.0, 1 * ms), Step::done);
  EXPECT_NEAR(machine.time(), 3.0 + 0.1 * ms, 1e-12);  // the current loop
  EXPECT_TRUE(machine.event_is_due() && machine.enter_event_mode());
  EXPECT_TRUE(machine.ticks(kClockReference, ticks) && !ticks);
  EXPECT_TRUE(machine.ticks(kClockReference + 2, ticks) && ticks);
  EXPECT_NEAR(machine.next_event_time(), 3.0 + 0.2 * ms, 1e-12);
  EXPECT_TRUE(machine.enter_step_mode());
  const double from = machine.time();
  EXPECT_EQ(machine.step(from, 0.03 * ms), Step::done);  // shorter than to the next tick
  EXPECT_NEAR(machine.time(), from + 0.03 * ms, 1e-12);
  EXPECT_FALSE(machine.event_is_due());
  ASSERT_TRUE(machine.restore(*machine.memory_from(bytes)));
  EXPECT_TRUE(machine.is_in_event_mode());
}

constexpr const char* kErrors =
    "[errors.e]\nEYX = { harmonic = { amplitude_um = 50.0, period_mm = 20.0 } }\n"
    "EZY = { grid = { axes = \"YX\", at_mm = [[-400, 400], [-500, 0, 500]], "
    "value_um = [[0, 5, 0], [10, 0, 10]] } }\nEC0Y = \"30 urad\"\nEAB = { constant_urad = 20.0 }\n";

// All five axes move, the errors are those of the scenario: the tool is where the run has it.
TEST(MachineInstance, PutsTheToolWhereARunHasIt) {
  const model::Scenario scenario =
      small_scenario("G21 G90 G94\nG1 X12 Y10 Z-5 B20 C30 F3000\nG1 X3 Y-8 Z4 B-5 C10\nM30\n",
                     "machine_errors = \"e\"\n[record]\nresolution_nm = 0\nperiod_ms = 0.7\n" +
                         std::string(kErrors) + "[[case]]\nname = \"plain\"\n");
  const Recorded recorded = recorded_of(scenario, "plain");
  MachineConstants constants;
  for (int joint = 0; joint < kJoints; ++joint) {
    constants.axes.push_back(exported_axis(scenario, joint, 0));
  }
  constants.kinematics = exported_kinematics(scenario);
  MachineInstance machine(constants, [](Severity severity, const std::string& why) {
    if (severity != Severity::event) ADD_FAILURE() << why;
  });
  const auto set = [&](const auto& inputs_of_joint) {
    for (int joint = 0; joint < kJoints; ++joint) {
      const AxisInputs in = inputs_of_joint(joint);
      const std::uint32_t first = static_cast<std::uint32_t>(joint) * kAxisStride;
      EXPECT_TRUE(machine.set(first + kSetpoint, in.setpoint) &&
                  machine.set(first + reference_of("velocity_setpoint"), in.velocity) &&
                  machine.set(first + reference_of("acceleration_setpoint"), in.acceleration));
    }
  };
  const auto seconds = [&](Tick n) { return scenario.machine.nc.periods.seconds(n); };
  set([&](int joint) { return at_rest(recorded, joint); });
  ASSERT_TRUE(machine.set_up(0.0) && machine.enter_initialization() &&
              machine.exit_initialization());
  const records::Series& servo = recorded.result.servo;
  Tick now = 0;
  double largest = 0.0;
  for (std::size_t row = 0; row < servo.rows(); ++row) {
    for (const Tick end = static_cast<Tick>(row) * scenario.record_period; now < end;) {
      set([&](int joint) { return inputs_at(recorded, now, joint); });
      const Tick next = std::min((now / kPosition + 1) * kPosition, end);
      ASSERT_EQ(machine.step(seconds(now), seconds(next) - seconds(now)), Step::done);
      now = next;
    }
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t first = kToolReference + kTipCoordinates;
      ASSERT_EQ(value(machine, first + k) / mm,
                servo.at(row, *servo.column("tool_position_true", "XYZ"[k])))
          << row;
      ASSERT_EQ(value(machine, first + 3 + k),
                servo.at(row, *servo.column("tool_axis_true", "IJK"[k])))
          << row;
      largest = std::max(largest, std::abs(value(machine, first + 6 + k)));
    }
  }
  EXPECT_GT(largest, 10 * um);
}

TEST(MachineInstance, FixesTheTipAfterInitialization) {
  MachineConstants constants = axes_of({0, 1, 2, 3, 4});
  constants.kinematics = exported_kinematics(rich_scenario());
  std::string message;
  MachineInstance machine(constants, [&](Severity, const std::string& why) { message = why; });
  constexpr std::uint32_t kTipZ = kToolReference + 2, kZ = kToolReference + 5;
  double z = 0.0;
  EXPECT_FALSE(machine.get(kZ, z));
  EXPECT_EQ(message, "'position' has no value before initialization");
  EXPECT_TRUE(machine.set(kTipZ, -0.1));
  EXPECT_FALSE(machine.set(kZ, 0.0));
  EXPECT_EQ(message, "'tool.position_z' cannot be set");
  ASSERT_TRUE(machine.set_up(0.0) && machine.enter_initialization() &&
              machine.exit_initialization());
  EXPECT_FALSE(machine.set(kTipZ, -0.2));
  EXPECT_EQ(message, "'tool.tip_z' is fixed after initialization");
  EXPECT_NEAR(value(machine, kZ), -0.1, 1 * um);
  const std::string bytes = machine.bytes_of(machine.memory());
  machine.reset();
  EXPECT_EQ(value(machine, kTipZ), 0.0);
  ASSERT_TRUE(machine.restore(*machine.memory_from(bytes)));
  EXPECT_EQ(value(machine, kTipZ), -0.1);
  EXPECT_FALSE(machine.get(kToolReference + kToolVariables, z));
  EXPECT_EQ(message, "no variable has the value reference 1012");
}

}  // namespace
}  // namespace servomill::sim::fmu::machine_instance_test
