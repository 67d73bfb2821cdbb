/// Faults of tests on a machine that cannot make them.
#pragma once

#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/model/machine_test.h"

namespace servomill::sim::model {
struct MachineSettings;
struct ProgramSpec;
}  // namespace servomill::sim::model

namespace servomill::sim::input {

/// Tests in which an axis would leave its travel, one fault an axis; feeds above the limits of the
/// axes; balls that are not on the rotary axis under test, or, where the axis turns about a ball,
/// that are.
/// @param program  its work offset and its tools
std::vector<Fault> faults_of_tests(const model::MachineTests& tests,
                                   const model::MachineSettings& machine,
                                   const model::ProgramSpec& program);

}  // namespace servomill::sim::input
