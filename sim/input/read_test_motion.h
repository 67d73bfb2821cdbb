/// Reads the motion of a test of the machine: axes, targets and feeds of [[test]].
#pragma once

#include "sim/config/reader.h"
#include "sim/model/machine_test.h"

namespace servomill::sim::input {

/// Keys of the motion, which depend on the standard. Those of other standards are refused.
/// @param out  with its standard
/// @return false if a fault leaves open which keys the test has
bool read_test_motion(config::Reader& table, const JointLayout& layout, model::MachineTest& out);

/// Lines along which targets are approached, once the positions of all axes are known.
void place_lines(config::Reader& table, const JointLayout& layout, model::MachineTest& out);

}  // namespace servomill::sim::input
