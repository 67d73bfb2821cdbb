/// Reads the tests that a run makes on the machine: [[test]].
#pragma once

#include <vector>

#include "sim/config/reader.h"
#include "sim/model/machine.h"
#include "sim/model/machine_test.h"

namespace servomill::sim::input {

/// Tables [[test]] of a scenario: positioning tests after ISO 230-2.
model::MachineTests read_machine_tests(config::Reader& root, const JointLayout& layout);

/// Faults of tests whose axis would leave its travel.
/// @param work_offset  of the program (6; m, rad)
std::vector<Fault> faults_of_travel(const model::MachineTests& tests,
                                    const model::MachineSettings& machine,
                                    const AxisWords& work_offset);

}  // namespace servomill::sim::input
