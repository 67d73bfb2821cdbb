#include "sim/run/machine_tests.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

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
  Eigen::Vector3d position;  // m, in the workpiece
  std::size_t begin = 0, end = 0;
};

// Columns of the TCP during one section of the program.
class TestRows {
 public:
  TestRows(const model::MachineTest& test, const evaluation::CaseData& one)
      : series_(*one.servo),
        time_(column("time", '\0', one)),
        nominal_(column("tool_position_nominal", 'X', one)),
        actual_(column("tool_position_true", 'X', one)) {
    const auto found = std::find(one.sections.begin(), one.sections.end(), test.name);
    const std::size_t section = column("section", '\0', one);
    const auto number = static_cast<double>(found - one.sections.begin());
    for (std::size_t row = 0; row < series_.rows(); ++row) {
      if (series_.at(row, section) == number) add(row);
    }
  }

  // Standstills that last so long, s.
  std::vector<Dwell> standstills(double least) const {
    std::vector<Dwell> out;
    for (const Dwell& one : dwells_) {
      if (end_of(one) - time(one.begin) >= least) out.push_back(one);
    }
    return out;
  }
  double end_of(const Dwell& dwell) const { return time(dwell.end - 1); }

  // Mean over the second half of the true TCP minus the programmed one, m.
  Eigen::Vector3d deviation(const Dwell& dwell) const {
    const double middle = 0.5 * (time(dwell.begin) + end_of(dwell));
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::size_t count = 0;
    for (std::size_t row = dwell.begin; row < dwell.end; ++row) {
      if (time(row) < middle) continue;
      sum += point(row, actual_) - point(row, nominal_);
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
  Eigen::Vector3d point(std::size_t row, std::size_t first) const {
    return Eigen::Vector3d(series_.at(row, first), series_.at(row, first + 1),
                           series_.at(row, first + 2)) *
           mm;
  }

  void add(std::size_t row) {
    constexpr double kSame = 1e-9;  // m
    const Eigen::Vector3d position = point(row, nominal_);
    if (!dwells_.empty() && dwells_.back().end == row &&
        (position - dwells_.back().position).norm() < kSame) {
      ++dwells_.back().end;
    } else {
      dwells_.push_back({position, row, row + 1});
    }
  }

  const records::Series& series_;
  std::size_t time_, nominal_, actual_;
  std::vector<Dwell> dwells_;
};

std::vector<standards::CycleStop> measured_stops(const standards::TestCycle& cycle) {
  std::vector<standards::CycleStop> out;
  for (const standards::CycleStop& stop : standards::stops(cycle)) {
    if (stop.direction != 0) out.push_back(stop);
  }
  return out;
}

// True if standstills from this one on are as far from each other as the stops are. Where the
// targets are in the workpiece depends on work offset, tool and rotary axes; their distances do
// not.
bool are_apart_like(std::span<const standards::CycleStop> stops, std::span<const Dwell> found) {
  constexpr double kTolerance = 1e-7;  // m
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const double wanted = std::abs(stops[i].position - stops[i - 1].position);
    const double distance = (found[i].position - found[i - 1].position).norm();
    if (std::abs(distance - wanted) > kTolerance) return false;
  }
  return true;
}

// The standstills at all stops. Before and after the cycle the axes may be at rest, too.
std::vector<Dwell> dwells_at(std::span<const standards::CycleStop> stops,
                             const std::vector<Dwell>& found) {
  for (std::size_t first = 0; first + stops.size() <= found.size(); ++first) {
    const std::span<const Dwell> some(found.data() + first, stops.size());
    if (are_apart_like(stops, some)) return {some.begin(), some.end()};
  }
  return {};
}

// Readings of the true TCP minus the target, along the line of the targets, in the order of the
// cycle.
std::vector<standards::TargetReading> true_readings(const model::MachineTest& test,
                                                    const evaluation::CaseData& one) {
  const TestRows rows(test, one);
  const std::vector<standards::CycleStop> stops = measured_stops(test.cycle);
  const std::vector<Dwell> dwells = dwells_at(stops, rows.standstills(0.5 * test.dwell));
  if (dwells.empty()) {
    throw InputError(test.place,
                     fmt::format("case {}: the recording does not show the {} standstills of test "
                                 "{}; lower record.period_ms",
                                 one.name, stops.size(), test.name));
  }
  const std::size_t last = test.cycle.targets.size() - 1;
  const Eigen::Vector3d along = (dwells[last].position - dwells[0].position).normalized();
  std::vector<standards::TargetReading> out;
  for (std::size_t k = 0; k < stops.size(); ++k) {
    standards::TargetReading reading;
    reading.target = stops[k].position;
    reading.direction = stops[k].direction;
    reading.run = stops[k].run;
    reading.deviation = rows.deviation(dwells[k]).dot(along);
    reading.time = rows.end_of(dwells[k]);
    reading.place = test.place;
    out.push_back(reading);
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
