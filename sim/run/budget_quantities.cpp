#include "sim/run/budget_quantities.h"

#include <algorithm>
#include <cassert>

#include "sim/evaluation/path_signal.h"
#include "sim/evaluation/quantity.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"

namespace servomill::sim::run {
namespace {

// The quantities of a scenario, and those of all cases and axes that it has none of.
std::vector<model::QuantitySpec> asked_for(const model::Scenario& scenario,
                                           std::span<const std::string> also) {
  std::vector<model::QuantitySpec> out = scenario.quantities;
  const JointLayout& layout = scenario.machine.chain.layout;
  for (const std::string& name : also) {
    assert(is_of_any_case(name));
    const auto has_name = [&](const model::QuantitySpec& one) { return one.name == name; };
    if (std::any_of(out.begin(), out.end(), has_name)) continue;
    model::QuantitySpec one;
    one.name = name;
    for (const model::CaseSpec& each : scenario.cases) one.cases.push_back(each.name);
    for (int joint = 0; joint < kLinearJoints; ++joint) {
      if (!layout.has(joint)) continue;
      one.axis = layout.letter_of(joint);
      out.push_back(one);
    }
  }
  return out;
}

}  // namespace

bool is_of_any_case(std::string_view quantity) {
  if (!evaluation::has_path_signal(quantity)) return false;
  const evaluation::QuantityEntry& info = evaluation::quantity_entry(quantity);
  return !info.needs_baseline && !info.needs_imposed;
}

std::vector<model::QuantitySpec> budget_quantities(const model::Scenario& scenario,
                                                   std::span<const std::string> also,
                                                   const std::vector<std::string>& sections) {
  std::vector<model::QuantitySpec> out;
  for (const model::QuantitySpec& asked : asked_for(scenario, also)) {
    model::QuantitySpec one = asked;
    const std::string_view derived_from = evaluation::quantity_entry(one.name).derived_from;
    if (!derived_from.empty()) one.name = derived_from;
    if (!evaluation::has_path_signal(one.name)) continue;
    one.statistic = "max";
    one.reference.clear();
    one.basis.clear();
    if (!sections.empty()) one.sections = sections;
    for (const std::string& name : asked.cases) {
      one.cases = {name};
      const bool known = std::any_of(out.begin(), out.end(), [&](const model::QuantitySpec& other) {
        return other.name == one.name && other.axis == one.axis && other.baseline == one.baseline &&
               other.sections == one.sections && other.cases == one.cases;
      });
      if (!known) out.push_back(one);
    }
  }
  return out;
}

}  // namespace servomill::sim::run
