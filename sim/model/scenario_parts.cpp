#include "sim/model/scenario_parts.h"

#include "sim/model/scenario.h"

namespace servomill::sim::model {

const std::string& name_of(const Scenario& scenario) { return scenario.name; }
const std::string& title_of(const Scenario& scenario) { return scenario.title; }
const MachineSettings& machine_of(const Scenario& scenario) { return scenario.machine; }

const std::map<std::string, plant::ErrorModel>& errors_of(const Scenario& scenario) {
  return scenario.errors;
}

std::shared_ptr<const UncertainErrors> uncertain_errors_of(const Scenario& scenario) {
  return scenario.uncertain;
}

std::vector<std::string> case_names(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const CaseSpec& one : scenario.cases) names.push_back(one.name);
  return names;
}

bool has_windows(const Scenario& scenario) { return scenario.record.windows.limited(); }
bool has_day(const Scenario& scenario) { return scenario.day != nullptr; }

}  // namespace servomill::sim::model
