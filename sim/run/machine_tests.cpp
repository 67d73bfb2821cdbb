#include "sim/run/machine_tests.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison.h"
#include "sim/standards/positioning_readings.h"
#include "sim/standards/positioning_report.h"
#include "sim/system/text_table.h"

namespace servomill::sim::run {
namespace {

using Eigen::Vector3d;

// Rows during which the interpolated position stays the same. A rewritten program has its own; its
// nominal position, of the original program at equal s, would drift along the path.
struct Standstill {
  double ref = 0.0;  // m; of the axis
  std::size_t begin = 0, end = 0;
};

using Columns = std::array<std::size_t, 3>;

// Positions of the TCP during one section of the program.
class TestRows {
 public:
  TestRows(const model::MachineTest& test, const evaluation::CaseData& one)
      : series_(*one.servo),
        time_(column("time", '\0', one)),
        ref_(column("ref_linear", letter(test.axis), one)),
        nominal_(columns("tool_position_nominal", one)),
        actual_(columns("tool_position_true", one)) {
    const auto found = std::find(one.sections.begin(), one.sections.end(), test.name);
    const std::size_t section = column("section", '\0', one);
    const auto number = static_cast<double>(found - one.sections.begin());
    for (std::size_t row = 0; row < series_.rows(); ++row) {
      if (series_.at(row, section) == number) add(row);
    }
  }

  // Standstills that last longer than this, s.
  std::vector<Standstill> standstills(double duration) const {
    std::vector<Standstill> out;
    for (const Standstill& one : all_) {
      if (end_of(one) - time(one.begin) > duration) out.push_back(one);
    }
    return out;
  }
  Vector3d nominal(const Standstill& one) const { return position(one.begin, nominal_); }
  double end_of(const Standstill& one) const { return time(one.end - 1); }

  // Mean of the true position in a part of the time, from 0 to 1, m.
  Vector3d mean(const Standstill& one, double from, double to) const {
    const double begin = time(one.begin), duration = end_of(one) - begin;
    Vector3d sum = Vector3d::Zero();
    std::size_t count = 0;
    for (std::size_t row = one.begin; row < one.end; ++row) {
      const double part = (time(row) - begin) / duration;
      if (part < from || part > to) continue;
      sum += position(row, actual_);
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
  static Columns columns(const char* name, const evaluation::CaseData& one) {
    return {column(name, 'X', one), column(name, 'Y', one), column(name, 'Z', one)};
  }
  double time(std::size_t row) const { return series_.at(row, time_); }
  Vector3d position(std::size_t row, const Columns& of) const {
    return Vector3d(series_.at(row, of[0]), series_.at(row, of[1]), series_.at(row, of[2])) * mm;
  }

  void add(std::size_t row) {
    constexpr double kSame = 1e-9;  // m
    const double ref = series_.at(row, ref_) * mm;
    if (!all_.empty() && all_.back().end == row && std::abs(ref - all_.back().ref) < kSame) {
      ++all_.back().end;
    } else {
      all_.push_back({ref, row, row + 1});
    }
  }

  const records::Series& series_;
  std::size_t time_, ref_;
  Columns nominal_, actual_;
  std::vector<Standstill> all_;
};

std::vector<standards::CycleStop> measured_stops(const standards::TestCycle& cycle) {
  std::vector<standards::CycleStop> out = standards::stops(cycle);
  std::erase_if(out, [](const standards::CycleStop& stop) { return stop.direction == 0; });
  return out;
}

// By which a rewritten program may be off: less than would confuse two stops.
double tolerance_of(const standards::TestCycle& cycle) {
  constexpr double kPart = 0.4, kMax = 0.25 * mm;
  double least = cycle.overrun;
  for (std::size_t i = 1; i < cycle.targets.size(); ++i) {
    least = std::min(least, cycle.targets[i] - cycle.targets[i - 1]);
  }
  return std::min(kPart * least, kMax);
}

// Standstills at the stops in their order, the first of them given; as many as are found. Their
// distances from the first target identify them, which work offsets do not change.
std::vector<Standstill> found_from(std::size_t first, const std::vector<Standstill>& all,
                                   const std::vector<standards::CycleStop>& stops,
                                   double tolerance) {
  std::vector<Standstill> out;
  auto next = all.begin() + static_cast<std::ptrdiff_t>(first);
  const double zero = next->ref;
  for (const standards::CycleStop& stop : stops) {
    const double distance = stop.position - stops.front().position;
    next = std::find_if(next, all.end(), [&](const Standstill& one) {
      return std::abs(one.ref - zero - distance) < tolerance;
    });
    if (next == all.end()) break;
    out.push_back(*next++);
  }
  return out;
}

// The last that fit: before them the axis may have been at rest elsewhere, for a tool change.
std::vector<Standstill> standstills_at(const std::vector<standards::CycleStop>& stops,
                                       const TestRows& rows, const model::MachineTest& test,
                                       const evaluation::CaseData& one) {
  const std::vector<Standstill> all = rows.standstills(0.5 * test.dwell);
  std::size_t most = 0;
  for (std::size_t first = all.size(); first-- > 0;) {
    std::vector<Standstill> found = found_from(first, all, stops, tolerance_of(test.cycle));
    if (found.size() == stops.size()) return found;
    most = std::max(most, found.size());
  }
  throw InputError(test.place,
                   fmt::format("case {}: test {}: {} of {} standstills at targets are in the "
                               "recording; each must last dwell_s and be at its target",
                               one.name, test.name, most, stops.size()));
}

struct TrueReadings {
  std::vector<standards::TargetReading> all;  // in the order of the cycle
  double creep = 0.0;                         // m
};

TrueReadings true_readings(const model::MachineTest& test, const evaluation::CaseData& one) {
  const TestRows rows(test, one);
  const std::vector<standards::CycleStop> stops = measured_stops(test.cycle);
  const std::vector<Standstill> at = standstills_at(stops, rows, test, one);
  const Vector3d beam =
      (rows.nominal(at[test.cycle.targets.size() - 1]) - rows.nominal(at.front())).normalized();
  const Vector3d zero = rows.mean(at.front(), 0.5, 1.0);
  TrueReadings out;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const standards::CycleStop& stop = stops[i];
    standards::TargetReading reading;
    reading.target = stop.position;
    reading.direction = stop.direction;
    reading.run = stop.run;
    reading.deviation =
        beam.dot(rows.mean(at[i], 0.5, 1.0) - zero) - (stop.position - stops.front().position);
    reading.time = rows.end_of(at[i]);
    reading.place = test.place;
    out.all.push_back(reading);
    const double creep = beam.dot(rows.mean(at[i], 0.75, 1.0) - rows.mean(at[i], 0.5, 0.75));
    out.creep = std::max(out.creep, std::abs(creep));
  }
  return out;
}

std::string number_text(double value, double unit) {
  return std::isnan(value) ? "-" : fmt::format("{:.2f}", value / unit);
}

}  // namespace

TestResult evaluate_test(const model::MachineTest& test, const evaluation::CaseData& one) {
  TrueReadings readings = true_readings(test, one);
  const standards::PositioningTest actual = standards::arrange(std::move(readings.all), false);
  standards::PositioningFile file;
  file.name = fmt::format("{}, case {}", test.name, one.name);
  file.test = standards::read_by_device(actual, test.device, test.seed);
  const standards::MonteCarloSettings trials{.seed = test.seed};
  TestResult out{
      test.name, file.test,
      standards::positioning_report(file, standards::UncertaintyInput{test.device, trials}),
      readings.creep};
  return out;
}

std::optional<std::string> note_of_creep(const TestResult& result, double dwell) {
  constexpr double kStandstill = 0.02 * um;  // a difference that the sheet shows
  if (!(result.creep > kStandstill)) return std::nullopt;
  return fmt::format(
      "test {}: the axis still moved by up to {:.2g} um while the device was read, which counts "
      "as its error; a dwell_s above {:g} lets it settle",
      result.name, result.creep / um, dwell);
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

std::vector<std::string> remarks_of(const std::vector<std::string>& names,
                                    const std::vector<const TestResult*>& results) {
  std::vector<std::pair<std::string, std::vector<std::string>>> cases_of;
  for (std::size_t k = 0; k < results.size(); ++k) {
    for (const std::string& remark : results[k]->report.remarks) {
      auto found = std::find_if(cases_of.begin(), cases_of.end(),
                                [&](const auto& one) { return one.first == remark; });
      if (found == cases_of.end()) found = cases_of.insert(found, {remark, {}});
      found->second.push_back(names[k]);
    }
  }
  std::vector<std::string> out;
  for (const auto& [remark, cases] : cases_of) {
    out.push_back(cases.size() == results.size()
                      ? remark
                      : fmt::format("{}: {}", fmt::join(cases, ", "), remark));
  }
  return out;
}

}  // namespace servomill::sim::run
