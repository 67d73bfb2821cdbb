/// The tool of an exported machine.
#include "sim/fmu/tool.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "tests/sim/fmu/exported.h"

namespace servomill::sim::fmu::tool_test {
namespace {

using plant::operator""_err;

constexpr std::size_t kPosition = 3, kAxis = 6, kDeviation = 9;

KinematicConstants machine() { return exported_kinematics(rich_scenario()); }

Joints at(double x, double y, double z, double b, double c) {
  Joints Q;
  Q << x, y, z, b, c;
  return Q;
}

Eigen::Vector3d part(const ToolValues& values, std::size_t first) {
  return Eigen::Vector3d::Map(&values[first]);
}

TEST(Tool, VariablesAreNumberedInOrder) {
  std::uint32_t next = kToolReference;
  for (const Variable& one : tool_variables()) {
    EXPECT_EQ(one.reference, next++);
    EXPECT_EQ(one.causality, one.reference < kToolReference + kTipCoordinates ? Causality::parameter
                                                                              : Causality::output);
  }
  EXPECT_EQ(next, kToolReference + kToolVariables);
}

TEST(Tool, StandsWhereTheLinearAxesAre) {
  const ToolValues values = Tool(machine()).values(at(0.1, -0.2, 0.3, 0.0, 0.0), {0, 0, -0.15});
  EXPECT_EQ(part(values, 0), Eigen::Vector3d(0, 0, -0.15));
  EXPECT_TRUE(part(values, kPosition).isApprox(Eigen::Vector3d(0.1, -0.2, 0.15), 1e-15));
  EXPECT_EQ(part(values, kAxis), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(part(values, kDeviation), Eigen::Vector3d::Zero());
}

// A tool at rest turns in the workpiece against a table that turns by c.
TEST(Tool, TurnsWithTheTable) {
  KinematicConstants turning = machine();
  turning.chain.at(Axis::C).centre.setZero();
  const double sense = turning.chain.at(Axis::C).sense == plant::Sense::tool ? 1.0 : -1.0;
  const ToolValues values =
      Tool(turning).values(at(0.1, 0.0, 0.0, 0.0, sense * 90 * deg), {0, 0, 0});
  EXPECT_NEAR((part(values, kPosition) - Eigen::Vector3d(0.0, 0.1, 0.0)).norm(), 0.0, 1e-15);
}

// EXX moves the tip along X; EC0Y tilts the way of Y towards -X.
TEST(Tool, DeviatesByItsErrors) {
  KinematicConstants wrong = machine();
  wrong.errors.component("EXX"_err) = plant::polynomial({3 * um, 50 * um});
  wrong.errors.location("EC0Y"_err) = 100e-6;
  const double y = wrong.chain.at(Axis::Y).centre.y();
  const ToolValues values = Tool(wrong).values(at(0.1, y + 0.2, 0.0, 0.0, 0.0), {0, 0, -0.1});
  EXPECT_NEAR(values[kDeviation], 3 * um + 5 * um - 20 * um, 1e-9);
  EXPECT_NEAR(values[kDeviation + 1], 0.0, 1e-8);
}

}  // namespace
}  // namespace servomill::sim::fmu::tool_test
