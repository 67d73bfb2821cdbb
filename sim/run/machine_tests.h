/// Tests of the machine in a run: readings of a simulated device, evaluated as those of a file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/model/machine_test.h"
#include "sim/standards/axis_positioning.h"
#include "sim/standards/report.h"

namespace servomill::sim::evaluation {
struct CaseData;
}  // namespace servomill::sim::evaluation

namespace servomill::sim::run {

struct TestResult {
  std::string name;                     // of the test
  standards::PositioningTest readings;  // with the errors of the device
  standards::Report report;
  double creep = 0.0;  // m; largest change of the position while the device is read
};

/// Reads the device in the second half of every dwell at a target, and evaluates the readings. The
/// device reads the true TCP in the workpiece along the axis; it is set to zero at the first
/// target.
/// @pre the case has finished
/// @throws InputError if the recording does not hold every standstill
TestResult evaluate_test(const model::MachineTest& test, const evaluation::CaseData& one);

/// "test X: the axis still moved by 0.40 um ..."; nothing if it was at rest.
std::optional<std::string> note_of_creep(const TestResult& result, double dwell);

/// Readings in the format that `servomill evaluate` reads.
std::string readings_csv(const standards::PositioningTest& readings);

/// Parameters of one test, a line each, the cases side by side.
/// @param names  of the cases
/// @param results  of the same test, a case each
std::string side_by_side(const std::vector<std::string>& names,
                         const std::vector<const TestResult*>& results);

/// Remarks of the results, each once; what does not hold for all of them with the names of its
/// cases.
std::vector<std::string> remarks_of(const std::vector<std::string>& names,
                                    const std::vector<const TestResult*>& results);

}  // namespace servomill::sim::run
