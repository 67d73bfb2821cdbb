/// Quantities that an error budget (budget.h) is made of.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/model/forward.h"

namespace servomill::sim::run {

/// True if each case has this quantity, asked for or not: tool_deviation, following_error.
bool is_of_any_case(std::string_view quantity);

/// Quantities of a scenario that have a budget, each case of each once: realised_ratio and
/// lag_time stand for imposed_error_residual; statistics do not matter.
/// @param also      quantities of any case; where the scenario has none of that name, of all cases
///                  and linear axes
/// @param sections  of the program, in place of those of the quantities; none: as they are, and
///                  all of it for `also`
/// @pre is_of_any_case(also)
std::vector<model::QuantitySpec> budget_quantities(const model::Scenario& scenario,
                                                   std::span<const std::string> also = {},
                                                   const std::vector<std::string>& sections = {});

}  // namespace servomill::sim::run
