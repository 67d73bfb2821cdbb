/// The cases of a scenario, prepared together.
#pragma once

#include <vector>

#include "sim/model/forward.h"
#include "sim/preparation/prepared_case.h"

namespace servomill::sim::preparation {

/// All cases of a scenario, as far as they can be prepared without a run of their programs.
/// @param scenario  must outlive them
/// @param cache     may be nullptr
/// @throws InputError with the faults of all cases: gains that are unstable included
std::vector<PreparedCase> prepare_untaught(const model::Scenario& scenario,
                                           PreparationCache* cache = nullptr);

/// Has the strategies that learn do so from runs of the programs.
/// @param cases  all of the scenario
/// @throws InputError with the faults of all cases
void teach(const model::Scenario& scenario, std::vector<PreparedCase>& cases,
           PreparationCache* cache = nullptr);

/// Cases that can be simulated: both.
std::vector<PreparedCase> prepare_cases(const model::Scenario& scenario,
                                        PreparationCache* cache = nullptr);

}  // namespace servomill::sim::preparation
