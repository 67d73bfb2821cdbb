/// Tests of a machine that a run makes: its program moves the axis, a simulated device reads it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"
#include "sim/standards/positioning_uncertainty.h"
#include "sim/standards/test_cycle.h"

namespace servomill::sim::model {

/// Positioning test of a linear axis after ISO 230-2, in work coordinates.
struct MachineTest {
  std::string name;  // and of the section of the program
  Axis axis = Axis::X;
  standards::TestCycle cycle;
  AxisWords at = AxisWords::Zero();  // m, rad; where the other axes are
  double feed = 0.0;                 // m/s
  double dwell = 0.0;                // s, at every target
  int tool = 0;                      // T; its TCP is the measured point; 0: the spindle nose
  standards::PositioningContributions device;
  std::uint64_t seed = 1;  // of the errors of the device
  Place place;
};

using MachineTests = std::vector<std::shared_ptr<const MachineTest>>;

/// Program of all tests, one section each.
std::string program_of(const MachineTests& tests, const JointLayout& layout);

}  // namespace servomill::sim::model
