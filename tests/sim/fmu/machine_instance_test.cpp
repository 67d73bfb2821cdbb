/// Several axes in one FMU.
#include "sim/fmu/machine_instance.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "tests/sim/fmu/exported.h"

namespace servomill::sim::fmu::machine_instance_test {
namespace {

const std::uint32_t kSetpoint = reference_of("position_setpoint"),
                    kPositionOf = reference_of("position");

std::vector<AxisConstants> axes_of(const std::vector<int>& joints) {
  const model::Scenario scenario = rich_scenario();
  std::vector<AxisConstants> axes;
  for (const int joint : joints) axes.push_back(exported_axis(scenario, joint, 0));
  return axes;
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

TEST(MachineInstance, ReadsTheConstantsOfItsAxes) {
  const std::string text = text_of(axes_of({2, 0, 4}));
  EXPECT_EQ(text_of(read_axes(text, "axis.txt")), text);
}

}  // namespace
}  // namespace servomill::sim::fmu::machine_instance_test
