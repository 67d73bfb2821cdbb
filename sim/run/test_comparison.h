/// Parameters of tests of the machine as rows of a comparison, as sweeps store them.
#pragma once

#include <span>
#include <vector>

namespace servomill::sim::model {
struct Scenario;
}  // namespace servomill::sim::model
namespace servomill::sim::evaluation {
struct ComparisonRow;
}  // namespace servomill::sim::evaluation

namespace servomill::sim::run {

struct CaseOutput;  // sim/run/run_case.h

/// A row for each parameter of each test of each case: the quantity is the symbol of the parameter,
/// the section that of the test.
/// @param outputs  of all cases in their order, or none: rows without values
std::vector<evaluation::ComparisonRow> rows_of_tests(const model::Scenario& scenario,
                                                     std::span<const CaseOutput> outputs);

}  // namespace servomill::sim::run
