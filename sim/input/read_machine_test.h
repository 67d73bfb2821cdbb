/// Reads the tests that a run makes on the machine: [[test]].
#pragma once

#include <vector>

#include "sim/config/reader.h"
#include "sim/model/machine.h"
#include "sim/model/machine_test.h"

namespace servomill::sim::model {
struct ProgramSpec;
}  // namespace servomill::sim::model

namespace servomill::sim::input {

/// Tables [[test]] of a scenario.
model::MachineTests read_machine_tests(config::Reader& root, const JointLayout& layout);

/// Faults of tests in which an axis would leave its travel, one each.
/// @param program  its work offset and its tools
std::vector<Fault> faults_of_travel(const model::MachineTests& tests,
                                    const model::MachineSettings& machine,
                                    const model::ProgramSpec& program);

}  // namespace servomill::sim::input
