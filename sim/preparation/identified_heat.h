/// Knowledge of a strategy that corrects errors by temperature.
#pragma once

#include <memory>
#include <string>

#include "sim/model/forward.h"
#include "sim/system/shared_cache.h"
#include "strategies/identified_heat.h"

namespace servomill::sim::preparation {

/// The machine whose thermal network the strategies of a case compute during a run; nullptr: none
/// does, or a machine has no heat.
const model::MachineSettings* known_heat_of(const model::CaseSpec& spec,
                                            const model::MachineSettings& machine);

/// Errors by temperature as a strategy of a case knows them; nullptr: it corrects none, or a
/// machine has no heat.
/// @param machine  of the case, whose sensors are read
/// @throws InputError if the known machine has sensors with errors that this one lacks
std::shared_ptr<const strategies::IdentifiedHeat> identified_heat(
    const model::StrategySpec& strategy, const model::CaseSpec& spec,
    const model::MachineSettings& machine);

/// Adds it to a key.
void add(system::MemoKey& key, const strategies::IdentifiedHeat& heat);

}  // namespace servomill::sim::preparation
