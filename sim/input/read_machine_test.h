/// Reads the tests that a run makes on the machine: [[test]].
#pragma once

#include "sim/config/reader.h"
#include "sim/model/machine_test.h"

namespace servomill::sim::input {

/// Tables [[test]] of a scenario.
model::MachineTests read_machine_tests(config::Reader& root, const JointLayout& layout);

}  // namespace servomill::sim::input
