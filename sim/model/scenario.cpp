#include "sim/model/scenario.h"

#include <algorithm>

namespace servomill::sim::model {

bool CaseSpec::needs_feedback_hardware() const {
  return std::any_of(strategies.begin(), strategies.end(),
                     [](const StrategySpec& one) { return one.entry->uses_feedback_hardware; });
}

bool RecordWindows::covers(const std::string& section) const {
  if (!limited()) return true;
  return every == 1 && std::find(sections.begin(), sections.end(), section) != sections.end();
}

const CaseSpec* Scenario::find_case(std::string_view case_name) const {
  for (const CaseSpec& one : cases) {
    if (one.name == case_name) return &one;
  }
  return nullptr;
}

std::optional<double> Scenario::signal_delay_of(const CaseSpec& one) const {
  if (one.servo == ServoModel::ideal) return std::nullopt;
  return machine.nc.periods.seconds(one.feedback_hardware ? hardware.signal_delay : 0);
}

}  // namespace servomill::sim::model
