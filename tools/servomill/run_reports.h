/// Reports of a run: its comparison, tests of the machine, days.
#pragma once

#include <string>

namespace servomill::sim::model {
struct Scenario;
}  // namespace servomill::sim::model
namespace servomill::sim::run {
struct RunOutput;
}  // namespace servomill::sim::run

namespace servomill::tools {

class Options;

/// Prints what a run has found, and writes the files of --touches and --readings.
/// @param path  of the result file
/// @return the exit status
int print_output(const sim::run::RunOutput& output, const Options& options,
                 const sim::model::Scenario& scenario, const std::string& path);

}  // namespace servomill::tools
