#include "sim/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace servomill::sim {

constexpr std::size_t kMostKeys = 2;

std::vector<std::vector<std::string>> grid_of(const Scenario& scenario) {
  std::vector<std::vector<std::string>> points(1);
  for (const SweepKey& key : scenario.sweep) {
    std::vector<std::vector<std::string>> extended;
    for (const auto& point : points) {
      for (const std::string& value : key.values) {
        extended.push_back(point);
        extended.back().push_back(value);
      }
    }
    points = std::move(extended);
  }
  return points;
}

namespace {

struct Grid {
  std::vector<std::vector<std::string>> values;
  std::vector<Scenario> scenarios;
};

std::string assignment(const SweepKey& key, const std::string& value) {
  return key.key + "=" + value;
}

// The user wrote a list in the scenario, not --set: faults of its values stand there.
InputError at_the_list(const InputError& error, const Scenario& base,
                       const std::vector<std::string>& values) {
  std::vector<Fault> faults = error.faults();
  for (Fault& fault : faults) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (fault.place.file == "--set " + assignment(base.sweep[k], values[k])) {
        fault.place = base.sweep[k].place;
        fault.message = fmt::format("sweep.\"{}\": {}", base.sweep[k].key, fault.message);
      }
    }
  }
  return InputError(std::move(faults));
}

// All points, read and prepared: a fault of the last is told before the first one runs.
Grid read_grid(const std::string& scenario_path, const std::vector<std::string>& changes) {
  const Scenario base = read_scenario(scenario_path, changes);
  if (base.sweep.empty()) {
    throw InputError({scenario_path},
                     "has no [sweep] table; add one such as [sweep] "
                     "\"program.feed_override\" = [0.5, 1.0]");
  }
  if (base.sweep.size() > kMostKeys) {
    throw InputError(
        base.sweep[kMostKeys].place,
        fmt::format("sweep has {} keys; at most {} are supported", base.sweep.size(), kMostKeys));
  }
  Grid grid{grid_of(base), {}};
  for (const auto& values : grid.values) {
    std::vector<std::string> all = changes;
    for (std::size_t k = 0; k < values.size(); ++k) {
      all.push_back(assignment(base.sweep[k], values[k]));
    }
    try {
      grid.scenarios.push_back(read_scenario(scenario_path, all));
      check_scenario(grid.scenarios.back());
    } catch (const InputError& error) {
      throw at_the_list(error, base, values);
    }
  }
  return grid;
}

}  // namespace

void check_sweep(const std::string& scenario_path, const std::vector<std::string>& changes) {
  read_grid(scenario_path, changes);
}

std::vector<SweepPoint> run_sweep(const std::string& scenario_path,
                                  const std::vector<std::string>& changes,
                                  const RunControl& control,
                                  const std::function<void(const SweepPoint&)>& point_done) {
  const auto [grid, scenarios] = read_grid(scenario_path, changes);
  if (control.prepared) control.prepared();

  std::vector<SweepPoint> points;
  const auto count = static_cast<double>(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    RunControl one = control;
    one.prepared = nullptr;
    if (control.progress) {
      one.progress = [&, i](double share) {
        control.progress((static_cast<double>(i) + share) / count);
      };
    }
    RunOutput output = run_scenario(scenarios[i], one);
    if (control.stop != nullptr && *control.stop) break;  // half a point is none
    points.push_back({grid[i], std::move(output.comparison), {}});
    for (const CaseOutput& run : output.cases) {
      if (run.result.outcome.finished) continue;
      points.back().stopped.push_back(
          fmt::format("case {} stopped: {}", run.name, run.result.outcome.reason));
    }
    if (point_done) point_done(points.back());
  }
  return points;
}

double number_of(const std::string& toml) {
  const std::size_t begin = toml.find_first_not_of("\"'");
  if (begin == std::string::npos) return std::numeric_limits<double>::quiet_NaN();
  char* end = nullptr;
  const double value = std::strtod(toml.c_str() + begin, &end);
  return end == toml.c_str() + begin ? std::numeric_limits<double>::quiet_NaN() : value;
}

}  // namespace servomill::sim
