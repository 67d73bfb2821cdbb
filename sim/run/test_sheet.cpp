#include "sim/run/test_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine_test.h"
#include "sim/model/scenario.h"
#include "sim/run/machine_tests.h"
#include "sim/standards/circle_test.h"
#include "sim/system/text_table.h"

namespace servomill::sim::run {
namespace {

std::string csv_of(const standards::PositioningTest& readings) {
  const double unit = readings.angular ? deg : mm;
  std::string out = readings.angular ? "direction,run,target_deg,deviation_urad\n"
                                     : "direction,run,target_mm,deviation_um\n";
  const auto append = [&](const char* direction, const Eigen::ArrayXXd& of, Eigen::Index run) {
    for (Eigen::Index i = 0; i < of.rows(); ++i) {
      const Eigen::Index k = direction[0] == 'f' ? i : of.rows() - 1 - i;
      out += fmt::format("{},{},{:.6f},{:.6f}\n", direction, run + 1, readings.targets[k] / unit,
                         of(k, run) / um);
    }
  };
  for (Eigen::Index run = 0; run < readings.up.cols(); ++run) {
    append("forward", readings.up, run);
    append("backward", readings.down, run);
  }
  return out;
}

std::string csv_of(const standards::CircleTest& circle) {
  std::string out = "direction,angle_deg,deviation_um\n";
  for (const standards::CirclePath& turn : circle.turns) {
    const bool is_counter = turn.sense == metrology::Sense::counter_clockwise;
    for (const Eigen::Vector2d& p : turn.points) {
      out += fmt::format("{},{:.9f},{:.6f}\n", is_counter ? "ccw" : "cw",
                         std::atan2(p.y(), p.x()) / deg, (p.norm() - circle.radius) / um);
    }
  }
  return out;
}

std::string csv_of(const SensorReadings& sensors) {
  std::string out = sensors.turns_are + ",angle_deg";
  for (const std::string_view name : sensors.sensors) out += fmt::format(",{}_um", name);
  out += "\n";
  for (const TurnReadings& turn : sensors.turns) {
    for (std::size_t i = 0; i < turn.angles.size(); ++i) {
      out += fmt::format("{},{:.9f}", turn.name, turn.angles[i] / deg);
      for (const std::vector<double>& values : turn.values) {
        out += fmt::format(",{:.6f}", values[i] / um);
      }
      out += "\n";
    }
  }
  return out;
}

std::string number_text(double value, double unit) {
  return std::isnan(value) ? "-" : fmt::format("{:.2f}", value / unit);
}

}  // namespace

std::vector<ReadingsFile> readings_files(const TestResult& result) {
  if (result.circle) return {{result.name + ".csv", csv_of(*result.circle)}};
  if (result.sensors) return {{result.name + ".csv", csv_of(*result.sensors)}};
  if (result.lines.size() == 1) return {{result.name + ".csv", csv_of(result.lines[0].test)}};
  std::vector<ReadingsFile> out;
  for (const LineReadings& line : result.lines) {
    out.push_back({fmt::format("{}/{}.csv", result.name, line.name), csv_of(line.test)});
  }
  return out;
}

ReportUnit unit_of(standards::Dimension dimension) {
  switch (dimension) {
    case standards::Dimension::length:
      return {um, "um"};
    case standards::Dimension::angle:
      return {urad, "urad"};
    case standards::Dimension::ratio:
      return {1e-6, "um/m"};
    case standards::Dimension::count:
      break;
  }
  return {1.0, "1"};
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
    const ReportUnit unit = unit_of(first.dimension);
    std::vector<std::string> line = {first.symbol, first.meaning};
    for (const TestResult* one : results) {
      line.push_back(number_text(one->report.values[k].value, unit.factor));
      line.push_back(number_text(one->report.values[k].U, unit.factor));
    }
    line.emplace_back(unit.name);
    lines.push_back(std::move(line));
  }
  std::set<std::size_t> right;
  for (std::size_t column = 2; column + 1 < lines.front().size(); ++column) right.insert(column);
  return system::text_table(std::move(lines), 0, right);
}

std::optional<std::string> note_of_missing_tests(const model::Scenario& scenario,
                                                 std::string_view command) {
  if (scenario.tests.empty()) return std::nullopt;
  std::string text = fmt::format(
      "servomill {} carries quantities; parameters of [[test]] are printed and stored by servomill "
      "run and sweep only",
      command);
  if (scenario.quantities.empty()) {
    throw InputError(scenario.tests.front()->place, text + ", and there is no [[quantity]]");
  }
  return text;
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
