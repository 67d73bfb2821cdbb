/// Sheets of tests of the machine: readings as files, parameters of the cases side by side.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/standards/report.h"

namespace servomill::sim::model {
struct Scenario;
}  // namespace servomill::sim::model

namespace servomill::sim::run {

struct TestResult;  // sim/run/machine_tests.h

struct ReadingsFile {
  std::string name;  // "X.csv"; of several diagonals "body/PPP.csv"
  std::string text;
};

/// Readings in the format that `servomill evaluate` reads.
std::vector<ReadingsFile> readings_files(const TestResult& result);

/// Unit in which parameters of tests are printed and stored.
struct ReportUnit {
  double factor = 1.0;
  const char* name = "1";
};
ReportUnit unit_of(standards::Dimension dimension);

/// Parameters of one test, a line each, the cases side by side.
/// @param names  of the cases
/// @param results  of the same test, a case each
std::string side_by_side(const std::vector<std::string>& names,
                         const std::vector<const TestResult*>& results);

/// Note that the parameters of [[test]] are missing in what a command prints, which carries
/// quantities only; nothing where there are no tests.
/// @throws InputError if there are no quantities either
std::optional<std::string> note_of_missing_tests(const model::Scenario& scenario,
                                                 std::string_view command);

/// Remarks of the results, each once; what does not hold for all of them with the names of its
/// cases.
std::vector<std::string> remarks_of(const std::vector<std::string>& names,
                                    const std::vector<const TestResult*>& results);

}  // namespace servomill::sim::run
