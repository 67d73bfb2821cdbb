/// Reports of a run beyond its comparison: tests of the machine, days.
#pragma once

namespace servomill::sim::model {
struct Scenario;
}  // namespace servomill::sim::model
namespace servomill::sim::run {
struct RunOutput;
}  // namespace servomill::sim::run

namespace servomill::tools {

class JsonList;
class Options;

/// Files of readings of each test, in a folder for each case (--readings).
void write_readings(const sim::run::RunOutput& output, const Options& options);

/// Parameters of each test, the cases that finished side by side.
void print_tests(const sim::run::RunOutput& output, const sim::model::Scenario& scenario);
/// The same, one object each.
void add_report_json(const sim::run::RunOutput& output, JsonList& list);

/// Drift and cycles of the day of each case.
void print_days(const sim::run::RunOutput& output);
/// False if a body went beyond its limits on one of them.
bool all_days_ended(const sim::run::RunOutput& output);

}  // namespace servomill::tools
