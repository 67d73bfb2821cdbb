/// Gains that strategies add to the position loops: from margins, and checked by them.
#pragma once

#include <string>
#include <vector>

#include "plant/vocabulary/added_gain.h"
#include "sim/model/forward.h"

namespace servomill::sim::preparation {

struct PreparationCache;

/// The largest gain (1/s) that leaves X, Y and Z of a case these margins; 0: none does.
double largest_added_gain(const model::Scenario& scenario, const model::CaseSpec& spec,
                          const WantedMargins& wanted, PreparationCache& cache);

/// Warns of each linear axis that has less than 45 deg or 6 dB with this gain.
/// @throws InputError where the loop is unstable with it
std::vector<std::string> check_added_gain(const model::Scenario& scenario,
                                          const model::CaseSpec& spec,
                                          const model::StrategySpec& strategy,
                                          const AddedGain& added, PreparationCache& cache);

}  // namespace servomill::sim::preparation
