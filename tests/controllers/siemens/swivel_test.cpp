// CYCLE800 and TRAORI on a machine with a table C on A, against its forward kinematics.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <memory>

#include "controllers/gcode/interpreter.h"
#include "controllers/path/tool_centre_point.h"
#include "plant/kinematics/chain.h"
#include "plant/vocabulary/units.h"
#include "siemens_examples.h"

namespace servomill::controllers::siemens::swivel_test {
namespace {

constexpr double kTol = 1e-9;  // m and 1, rounding of angles to a picometre in the lines
const Eigen::Vector3d kTip(0.0, 0.0, -0.1);

ProgramSetup setup_with_machine() {
  ProgramSetup setup = example_setup();
  setup.machine = std::make_shared<const ToolCentrePoint>(
      plant::make_chain(plant::parse_structure("[w C A b X Y Z t]")), Joints::Constant(-10.0),
      Joints::Constant(10.0), 1e-6);
  return setup;
}

// The tool at the end of the last motion of the lines, which holds the tip
// (plant/vocabulary/move.h).
ToolPose end_of(const std::string& lines) {
  const ProgramSetup setup = setup_with_machine();
  const plant::MachineChain& chain = setup.machine->chain();
  Interpreter interpreter(with_frame(lines), "t.mpf", setup);
  AxisWords end = AxisWords::Zero();
  for (const Move& move : interpreter.rest()) {
    if (is_motion(move.kind)) end = move.end_machine;
  }
  return {end.head<3>(), plant::forward(chain, chain.layout.joints(end), kTip).k_W};
}

Eigen::Matrix3d about(int axis, double angle) {
  return Eigen::AngleAxisd(angle * deg, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
}

void expect_pose(const ToolPose& pose, const Eigen::Vector3d& tip, const Eigen::Vector3d& axis) {
  EXPECT_LT((pose.p_WT - tip).norm(), kTol) << pose.p_WT.transpose();
  EXPECT_LT((pose.k_W - axis).norm(), kTol) << pose.k_W.transpose();
}

// The plane has its origin at (10, 0, 5), turned by 30 degrees about X: _MODE 57 is X, Y, Z
TEST(Swivel, OneAngle) {
  const Eigen::Matrix3d R = about(0, 30.0);
  expect_pose(end_of("CYCLE800(0,\"TC\",0,57,10,0,5,30,0,0,0,0,0,1)\nG0 X1 Y2 Z3\n"),
              (Eigen::Vector3d(10.0, 0.0, 5.0) + R * Eigen::Vector3d(1.0, 2.0, 3.0)) * mm,
              R.col(2));
}

// _MODE 27: rotation about Z, Y and X, each about the rotated axis; _X1 ... shift after it
TEST(Swivel, SeveralAnglesAndAShiftBehindThem) {
  const Eigen::Matrix3d R = about(2, 20.0) * about(1, 15.0) * about(0, -10.0);
  expect_pose(end_of("CYCLE800(0,\"TC\",0,27,0,0,0,20,15,-10,1,2,3,-1)\nG0 X0 Y0 Z1\n"),
              R * Eigen::Vector3d(1.0, 2.0, 4.0) * mm, R.col(2));
}

// A hole along the tool
TEST(Swivel, CyclesDrillAcrossThePlane) {
  const Eigen::Matrix3d R = about(0, 30.0);
  expect_pose(end_of("F100\nCYCLE800(0,\"TC\",0,57,0,0,0,30,0,0,0,0,0,1)\nG0 X1 Y2 Z9\n"
                     "CYCLE81(7,0,2,-3)\n"),
              R * Eigen::Vector3d(1.0, 2.0, 7.0) * mm, R.col(2));
}

// SUPA leaves the plane for its block; CYCLE800() ends it, and the rotary axes stay
TEST(Swivel, MachineCoordinatesAndTheEnd) {
  const std::string plane = "CYCLE800(0,\"TC\",0,57,0,0,0,30,0,0,0,0,0,1)\nG0 X1 Y2 Z3\n";
  const ProgramSetup setup = setup_with_machine();
  Interpreter interpreter(
      with_frame(plane + "SUPA Z=200 D0\nCYCLE800()\nG0 A0 C0\nG0 X5 Y6 D1\nZ7\n"), "t.mpf", setup);
  std::vector<double> heights;
  AxisWords end = AxisWords::Zero();
  for (const Move& move : interpreter.rest()) {
    if (move.line == 6) heights.push_back(move.end_machine[2] / mm);
    if (is_motion(move.kind)) end = move.end_machine;
  }
  ASSERT_EQ(heights.size(), 1u);
  EXPECT_NEAR(heights[0], 200.0, 1e-9);
  const Eigen::Vector3d tip = end.head<3>() + kTip;
  EXPECT_LT((tip - Eigen::Vector3d(5.0, 6.0, 7.0) * mm).norm(), kTol) << tip.transpose();
}

// The tip stays at the programmed point whatever the rotary axes do
TEST(Swivel, TipControl) {
  const ToolPose pose = end_of("G0 X10 Y0 Z5\nTRAORI\nG1 X1 Y2 Z3 A30 C40 F100\n");
  EXPECT_LT((pose.p_WT - Eigen::Vector3d(1.0, 2.0, 3.0) * mm).norm(), kTol);
  EXPECT_NEAR(pose.k_W.z(), std::cos(30.0 * deg), 1e-12);
}

TEST(Swivel, Refusals) {
  const std::string plane = "CYCLE800(0,\"TC\",0,57,0,0,0,0,0,0,0,0,0,0)\n";
  EXPECT_EQ(fault_of(plane + "G0 A5\n"),
            "t.mpf:5:1: error: rotary axes cannot be programmed in a plane of CYCLE800; program "
            "CYCLE800() first");
  EXPECT_EQ(fault_of(plane + "T2 M6\n"),
            "t.mpf:5:1: error: a tool change is not allowed in a plane of CYCLE800; program "
            "CYCLE800() first");
  EXPECT_EQ(
      fault_of(plane + "TRAORI\n"),
      "t.mpf:5:1: error: TRAORI is not allowed in a plane of CYCLE800; program CYCLE800() first");
  EXPECT_EQ(fault_of("TRAORI\nCYCLE800()\n"),
            "t.mpf:5:1: error: CYCLE800 is not allowed with TRAORI; cancel it with TRAFOOF");
  EXPECT_EQ(fault_of("CYCLE800(0,\"TC\",0,192,0,0,0,30,0,0,0,0,0,1)\n"),
            "t.mpf:4:1: error: CYCLE800: only axis-by-axis swivelling (_MODE up to 63) is "
            "supported; solid angles, projection angles and direct rotary axes are not");
  EXPECT_EQ(fault_of("CYCLE800(0,\"TC\",1,57)\n"),
            "t.mpf:4:1: error: CYCLE800: only new planes without tool tip correction (_ST = 0) are "
            "supported");
}

}  // namespace
}  // namespace servomill::controllers::siemens::swivel_test
