/// Tests of the machine in a run: readings of a simulated device, evaluated as those of a file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/standards/axis_positioning.h"
#include "sim/standards/report.h"

namespace servomill::sim::model {
struct MachineTest;
}  // namespace servomill::sim::model
namespace servomill::sim::evaluation {
struct CaseData;
}  // namespace servomill::sim::evaluation
namespace servomill::sim::standards {
struct CircleTest;
}  // namespace servomill::sim::standards

namespace servomill::sim::run {

/// Feeds of the axes of a test, m/s, of a rotary axis rad/s.
struct FeedRange {
  double min = 0.0, max = 0.0;
};

/// Readings along one line.
struct LineReadings {
  std::string name;  // of the test, or of the diagonal
  standards::PositioningTest test;
};

/// Readings of sensors while a rotary axis turns, a turn each.
struct TurnReadings {
  std::string name;                         // "forward", "backward"; of a revolution "1", "2", ...
  std::vector<double> angles;               // rad
  std::vector<std::vector<double>> values;  // m; of each sensor
};
struct SensorReadings {
  std::string turns_are;                  // column of their names: "direction", "revolution"
  std::vector<std::string_view> sensors;  // columns without a unit: "x", "radial"
  std::vector<TurnReadings> turns;
};

/// Readings with the errors of the device, and what the standard makes of them.
struct TestResult {
  std::string name;                 // of the test
  std::vector<LineReadings> lines;  // one, or a diagonal each
  std::shared_ptr<const standards::CircleTest> circle;
  std::shared_ptr<const SensorReadings> sensors;
  standards::Report report;
  double creep = 0.0;     // m, rad; largest change of the position while the device is read at rest
  bool is_angle = false;  // of the creep
  FeedRange feeds;        // while the device is read in motion; 0: it is read at rest
};

/// Reads the device in the second half of every dwell at a target: the true TCP in the workpiece
/// along the line, from zero at its first target, or the rotation of the spindle against the
/// workpiece about a rotary axis. A ball bar is read on the turn: the distance of the TCP from
/// where it was at the centre. Sensors about a rotary axis: sim/run/rotary_tests.h.
/// A remark of the report names the feed of a motion that does not reach the programmed one.
/// @pre the case has finished
/// @param feed_override  of the program
/// @throws InputError if the recording does not hold every standstill
TestResult evaluate_test(const model::MachineTest& test, const evaluation::CaseData& one,
                         double feed_override = 1.0);

/// "test X: the axis still moved by 0.40 um ..."; nothing if it was at rest.
std::optional<std::string> note_of_creep(const TestResult& result, double dwell);

}  // namespace servomill::sim::run
