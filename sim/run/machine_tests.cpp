#include "sim/run/machine_tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison.h"
#include "sim/standards/positioning_readings.h"
#include "sim/standards/positioning_report.h"
#include "sim/system/text_table.h"

namespace servomill::sim::run {
namespace {

// Rows during which the programmed position stays the same.
struct Dwell {
  double position = 0.0;  // m
  std::size_t begin = 0, end = 0;
};

// Columns of one axis during one section of the program.
class TestRows {
 public:
  TestRows(const model::MachineTest& test, const evaluation::CaseData& one)
      : series_(*one.servo),
        time_(column("time", '\0', one)),
        nominal_(column("tool_position_nominal", letter(test.axis), one)),
        actual_(column("tool_position_true", letter(test.axis), one)) {
    const auto found = std::find(one.sections.begin(), one.sections.end(), test.name);
    const std::size_t section = column("section", '\0', one);
    const auto number = static_cast<double>(found - one.sections.begin());
    for (std::size_t row = 0; row < series_.rows(); ++row) {
      if (series_.at(row, section) == number) add(row);
    }
  }

  const std::vector<Dwell>& dwells() const { return dwells_; }
  double duration(const Dwell& dwell) const { return time(dwell.end - 1) - time(dwell.begin); }
  double end_of(const Dwell& dwell) const { return time(dwell.end - 1); }

  // Mean of the true position in the second half, m.
  double reading(const Dwell& dwell) const {
    const double middle = 0.5 * (time(dwell.begin) + time(dwell.end - 1));
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t row = dwell.begin; row < dwell.end; ++row) {
      if (time(row) < middle) continue;
      sum += series_.at(row, actual_) * mm;
      ++count;
    }
    return sum / static_cast<double>(count);
  }

 private:
  static std::size_t column(const char* name, char label, const evaluation::CaseData& one) {
    const auto found = one.servo->column(name, label);
    if (!found) throw InputError({one.name}, fmt::format("test needs the signal {}", name));
    return *found;
  }
  double time(std::size_t row) const { return series_.at(row, time_); }

  void add(std::size_t row) {
    constexpr double kSame = 1e-9;  // m
    const double position = series_.at(row, nominal_) * mm;
    if (!dwells_.empty() && dwells_.back().end == row &&
        std::abs(position - dwells_.back().position) < kSame) {
      ++dwells_.back().end;
    } else {
      dwells_.push_back({position, row, row + 1});
    }
  }

  const records::Series& series_;
  std::size_t time_, nominal_, actual_;
  std::vector<Dwell> dwells_;
};

// Readings of the true position minus the target, in the order of the cycle.
std::vector<standards::TargetReading> true_readings(const model::MachineTest& test,
                                                    const evaluation::CaseData& one) {
  constexpr double kAtTarget = 1e-7;  // m
  const TestRows rows(test, one);
  std::vector<standards::TargetReading> out;
  auto dwell = rows.dwells().begin();
  for (const standards::CycleStop& stop : standards::stops(test.cycle)) {
    if (stop.direction == 0) continue;
    dwell = std::find_if(dwell, rows.dwells().end(), [&](const Dwell& d) {
      return std::abs(d.position - stop.position) < kAtTarget &&
             rows.duration(d) > 0.5 * test.dwell;
    });
    if (dwell == rows.dwells().end()) {
      throw InputError(test.place,
                       fmt::format("case {}: the recording has no standstill at {:g} mm in run {}; "
                                   "set record.period_ms",
                                   one.name, stop.position / mm, stop.run + 1));
    }
    standards::TargetReading reading;
    reading.target = stop.position;
    reading.direction = stop.direction;
    reading.run = stop.run;
    reading.deviation = rows.reading(*dwell) - stop.position;
    reading.time = rows.end_of(*dwell);
    reading.place = test.place;
    out.push_back(reading);
    ++dwell;
  }
  const double zero = out.front().deviation;
  for (standards::TargetReading& reading : out) reading.deviation -= zero;
  return out;
}

std::string number_text(double value, double unit) {
  return std::isnan(value) ? "-" : fmt::format("{:.2f}", value / unit);
}

}  // namespace

TestResult evaluate_test(const model::MachineTest& test, const evaluation::CaseData& one) {
  const standards::PositioningTest actual = standards::arrange(true_readings(test, one), false);
  standards::PositioningFile file;
  file.name = fmt::format("{}, case {}", test.name, one.name);
  file.test = standards::read_by_device(actual, test.device, test.seed);
  const standards::MonteCarloSettings trials{.seed = test.seed};
  TestResult out{
      test.name, file.test,
      standards::positioning_report(file, standards::UncertaintyInput{test.device, trials})};
  return out;
}

std::string readings_csv(const standards::PositioningTest& readings) {
  std::string out = "direction,run,target_mm,deviation_um\n";
  const auto append = [&](const char* direction, const Eigen::ArrayXXd& of, Eigen::Index run) {
    for (Eigen::Index i = 0; i < of.rows(); ++i) {
      const Eigen::Index k = direction[0] == 'f' ? i : of.rows() - 1 - i;
      out += fmt::format("{},{},{:.6f},{:.6f}\n", direction, run + 1, readings.targets[k] / mm,
                         of(k, run) / um);
    }
  };
  for (Eigen::Index run = 0; run < readings.up.cols(); ++run) {
    append("forward", readings.up, run);
    append("backward", readings.down, run);
  }
  return out;
}

std::string side_by_side(const std::vector<std::string>& names,
                         const std::vector<const TestResult*>& results) {
  std::vector<std::vector<std::string>> lines = {{"parameter", "meaning"}};
  for (const std::string& name : names) {
    lines.front().push_back(name);
    lines.front().push_back("U (k = 2)");
  }
  lines.front().emplace_back("unit");
  for (std::size_t k = 0; k < results.front()->report.values.size(); ++k) {
    const standards::ReportValue& first = results.front()->report.values[k];
    std::vector<std::string> line = {first.symbol, first.meaning};
    for (const TestResult* one : results) {
      line.push_back(number_text(one->report.values[k].value, um));
      line.push_back(number_text(one->report.values[k].U, um));
    }
    line.emplace_back("um");
    lines.push_back(std::move(line));
  }
  std::set<std::size_t> right;
  for (std::size_t column = 2; column + 1 < lines.front().size(); ++column) right.insert(column);
  return system::text_table(std::move(lines), 0, right);
}

}  // namespace servomill::sim::run
