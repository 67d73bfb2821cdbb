#include "sim/run/store_tests.h"

#include <fmt/format.h>

#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/records/output_file.h"
#include "sim/run/machine_tests.h"
namespace servomill::sim::run {
namespace {

void write_readings(records::Hdf5Group& group, const char* name, const char* direction,
                    const Eigen::ArrayXXd& deviations) {
  std::vector<double> rows;
  for (Eigen::Index i = 0; i < deviations.rows(); ++i) {
    for (Eigen::Index run = 0; run < deviations.cols(); ++run) {
      rows.push_back(deviations(i, run) / um);
    }
  }
  group.table(name, static_cast<std::size_t>(deviations.cols()), rows,
              {"um", fmt::format("actual minus target position, approached {}", direction)},
              "target", "run");
}

void write_test(records::Hdf5Group group, const TestResult& one) {
  const standards::PositioningTest& readings = one.readings;
  group.attribute("standard", one.report.standard);
  std::vector<double> targets, runs;
  for (const double target : readings.targets) targets.push_back(target / mm);
  for (Eigen::Index run = 0; run < readings.up.cols(); ++run) {
    runs.push_back(static_cast<double>(run + 1));
  }
  group.list("target", targets, {"mm", "target position in work coordinates"});
  group.list("run", runs, {"1", "number of the run"});
  write_readings(group, "deviation_up", "upwards", readings.up);
  write_readings(group, "deviation_down", "downwards", readings.down);
  for (const standards::ReportValue& value : one.report.values) {
    group.scalar(value.symbol, value.value / um, {"um", value.meaning});
    group.scalar("U_" + value.symbol, value.U / um,
                 {"um", "expanded uncertainty (k = 2) of " + value.symbol});
  }
}

}  // namespace

void write_tests(records::Hdf5Group group,
                 std::span<const std::shared_ptr<const TestResult>> tests) {
  for (const auto& one : tests) write_test(group.group(one->name), *one);
}

}  // namespace servomill::sim::run
