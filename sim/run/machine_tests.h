/// Tests of the machine in a run: readings of a simulated device, evaluated as those of a file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/standards/axis_positioning.h"
#include "sim/standards/report.h"

namespace servomill::sim::model {
struct MachineTest;
}  // namespace servomill::sim::model
namespace servomill::sim::standards {
struct CircleTest;
}  // namespace servomill::sim::standards
namespace servomill::sim::evaluation {
struct CaseData;
}  // namespace servomill::sim::evaluation

namespace servomill::sim::run {

/// Readings along one line.
struct LineReadings {
  std::string name;  // of the test, or of the diagonal
  standards::PositioningTest test;
};

/// Readings with the errors of the device, and what the standard makes of them.
struct TestResult {
  std::string name;                 // of the test
  std::vector<LineReadings> lines;  // one, or a diagonal each
  std::shared_ptr<const standards::CircleTest> circle;
  standards::Report report;
  double creep = 0.0;  // m; largest change of the position while the device is read at rest
};

/// Reads the device in the second half of every dwell at a target: the true TCP in the workpiece
/// along the line, from zero at its first target. A ball bar is read on the turn: the distance of
/// the TCP from where it was at the centre.
/// @pre the case has finished
/// @throws InputError if the recording does not hold every standstill
TestResult evaluate_test(const model::MachineTest& test, const evaluation::CaseData& one);

/// "test X: the axis still moved by 0.40 um ..."; nothing if it was at rest.
std::optional<std::string> note_of_creep(const TestResult& result, double dwell);

}  // namespace servomill::sim::run
