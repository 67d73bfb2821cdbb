/// Results of tests of the machine in a result file.
#pragma once

#include <memory>
#include <span>
namespace servomill::sim::records {
class Hdf5Group;
}  // namespace servomill::sim::records

namespace servomill::sim::run {

struct TestResult;  // sim/run/machine_tests.h

/// A group for each test: targets, readings of both directions by run, and the parameters with
/// their expanded uncertainty, NaN where it is not stated.
void write_tests(records::Hdf5Group group,
                 std::span<const std::shared_ptr<const TestResult>> tests);

}  // namespace servomill::sim::run
