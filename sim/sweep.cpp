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

std::vector<SweepPoint> run_sweep(const std::string& scenario_path,
                                  const std::vector<std::string>& changes,
                                  const RunControl& control,
                                  const std::function<void(const SweepPoint&)>& point_done) {
  const Scenario base = read_scenario(scenario_path, changes);
  if (base.sweep.empty()) {
    throw InputError({scenario_path},
                     "has no [sweep] table; add one such as [sweep] "
                     "\"program.feed_override\" = [0.5, 1.0]");
  }
  if (base.sweep.size() > kMostKeys) {
    throw InputError({scenario_path}, fmt::format("[sweep] has {} keys; at most {} are supported",
                                                  base.sweep.size(), kMostKeys));
  }
  const auto grid = grid_of(base);
  std::vector<Scenario> scenarios;
  for (const auto& values : grid) {
    std::vector<std::string> all = changes;
    for (std::size_t k = 0; k < values.size(); ++k) {
      all.push_back(base.sweep[k].key + "=" + values[k]);
    }
    scenarios.push_back(read_scenario(scenario_path, all));
  }

  std::vector<SweepPoint> points;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    RunControl one = control;
    if (control.progress) {
      one.progress = [&](double share) {
        control.progress((static_cast<double>(i) + share) / static_cast<double>(grid.size()));
      };
    }
    points.push_back({grid[i], run_scenario(scenarios[i], one).comparison});
    if (point_done) point_done(points.back());
    if (control.stop != nullptr && *control.stop) break;
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
