/// Reads the strategies of a case.
#pragma once

#include <span>
#include <string>

#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// One [[case.strategy]], added to those of `spec`: type, sign, model and the parameters that the
/// registry lists for that type. A strategy at fault in its type is left out.
/// @param error_models  names of all models of the scenario
/// @return its key `machine`, for a strategy that runs the program; nullptr: it has none
const config::Value* read_strategy(config::Reader& table, std::span<const std::string> error_models,
                                   model::CaseSpec& spec);

}  // namespace servomill::sim::input
