#include "sim/preparation/identified_heat.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "sim/model/heat.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/refusals.h"

namespace servomill::sim::preparation {
namespace {

const model::MachineSettings& known_by(const model::StrategySpec& strategy,
                                       const model::MachineSettings& machine) {
  return strategy.machine ? *strategy.machine : machine;
}

bool computes_heat(const model::StrategySpec& strategy) {
  const auto computes = strategy.entry->computes_heat;
  return computes != nullptr && computes(strategy.parameters);
}

// Place of a sensor of the known machine among those that are read.
int place_of(const model::HeatSensor& sensor, const model::HeatSettings& read) {
  const auto found = std::find_if(read.sensors.begin(), read.sensors.end(),
                                  [&](const auto& one) { return one.name == sensor.name; });
  if (found != read.sensors.end()) return static_cast<int>(found - read.sensors.begin());
  std::vector<std::string> names;
  for (const model::HeatSensor& one : read.sensors) names.push_back(one.name);
  throw InputError(
      {},
      fmt::format("machine has errors_per_K of a sensor '{}' that the machine of "
                  "the case lacks; it has {}",
                  sensor.name, names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

}  // namespace

const model::MachineSettings* known_heat_of(const model::CaseSpec& spec,
                                            const model::MachineSettings& machine) {
  for (const model::StrategySpec& strategy : spec.strategies) {
    if (!computes_heat(strategy)) continue;
    const model::MachineSettings& known = known_by(strategy, machine);
    return machine.heat && known.heat ? &known : nullptr;
  }
  return nullptr;
}

std::shared_ptr<const strategies::IdentifiedHeat> identified_heat(
    const model::StrategySpec& strategy, const model::CaseSpec& spec,
    const model::MachineSettings& machine) {
  const auto& heat = known_by(strategy, machine).heat;
  if (!strategy.entry->corrects_heat || !heat || !machine.heat) return nullptr;
  auto out = std::make_shared<strategies::IdentifiedHeat>();
  out->by_body = heat->errors;
  out->reference = heat->reference;
  if (computes_heat(strategy)) return out;  // reads no sensor
  try {
    for (const plant::ThermalError& one : heat->sensor_errors) {
      const model::HeatSensor& sensor = heat->sensors[static_cast<std::size_t>(one.body)];
      out->by_sensor.push_back({place_of(sensor, *machine.heat), one.per_kelvin});
    }
  } catch (const InputError& error) {
    throw fault_of(strategy, spec.name, error);
  }
  return out;
}

void add(system::MemoKey& key, const strategies::IdentifiedHeat& heat) {
  key.add(heat.reference);
  for (const auto* errors : {&heat.by_body, &heat.by_sensor}) {
    key.add(errors->size());
    for (const plant::ThermalError& one : *errors) {
      key.add(one.body);
      add(key, one.per_kelvin);
    }
  }
}

}  // namespace servomill::sim::preparation
