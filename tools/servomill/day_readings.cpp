#include "tools/servomill/day_readings.h"

#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/input_error.h"
#include "sim/calibration/heat_regression.h"
#include "sim/input/read_scenario.h"
#include "sim/model/heat.h"
#include "sim/model/scenario.h"
#include "sim/model/working_day.h"
#include "sim/records/input_file.h"
#include "sim/run/day_course.h"
#include "sim/run/store_day.h"
#include "tools/servomill/command.h"

namespace servomill::tools {
namespace {

// The case of --case, or the only one with a day.
std::string case_of(const sim::records::InputFile& file, const Options& options) {
  std::vector<std::string> names;
  for (const std::string& name : file.groups("/cases")) {
    if (file.has("/cases/" + name + "/day")) names.push_back(name);
  }
  if (names.empty()) throw InputError({file.path()}, "has no case with a day ([day])");
  if (!options.has("case")) {
    if (names.size() == 1) return names.front();
    throw InputError({"--case"}, fmt::format("is missing; {} has days of {}", file.path(),
                                             fmt::join(names, ", ")));
  }
  const auto& wanted = options.get<std::string>("case");
  if (std::find(names.begin(), names.end(), wanted) != names.end()) return wanted;
  throw InputError({"--case"}, fmt::format("{} has no day of a case '{}'; it has days of {}",
                                           file.path(), wanted, fmt::join(names, ", ")));
}

// Drift that a compensation has already reduced is not that of the machine.
void refuse_compensated(const sim::model::Scenario& scenario, const std::string& name,
                        const std::string& path) {
  const sim::model::CaseSpec* spec = scenario.find_case(name);
  if (spec == nullptr) return;
  for (const sim::model::StrategySpec& strategy : spec->strategies) {
    if (!strategy.entry->corrects_heat) continue;
    throw InputError({path}, fmt::format("case {} has the strategy {}: its drift is the residual "
                                         "of this strategy; name a case without it",
                                         name, strategy.entry->name));
  }
}

}  // namespace

sim::calibration::HeatReadings day_readings(const std::string& path, const Options& options) {
  const sim::records::InputFile file(path);
  const std::string name = case_of(file, options);
  const sim::model::Scenario scenario = sim::input::read_resolved_scenario(
      file.text("/inputs", "resolved"), path + ":/inputs",
      std::make_shared<const StoredText>(file.stored_text("/inputs", "program")));
  refuse_compensated(scenario, name, path);
  const auto day = sim::run::read_day(file, "/cases/" + name + "/day");
  sim::calibration::HeatReadings out{path, day->sensors, {}};
  if (out.sensors.empty()) throw InputError({path}, "its machine has no temperature sensors");
  for (std::size_t k = 0; k < day->places.size(); ++k) {
    const auto& places = scenario.day->places;
    const auto place = std::find_if(places.begin(), places.end(),
                                    [&](const auto& one) { return one.name == day->places[k]; });
    for (std::size_t n = 0; place != places.end() && n < day->time.size(); ++n) {
      sim::calibration::HeatReading one{place->Q, place->p_ST, {}, {}};
      for (const auto& readings : day->readings) one.T.push_back(readings[n]);
      const auto& drift = day->drift[k][n];
      one.drift = {drift[0], drift[1], drift[2]};
      out.rows.push_back(std::move(one));
    }
  }
  return out;
}

}  // namespace servomill::tools
