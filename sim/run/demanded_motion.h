/// Motion that a case asks its axes for, against their limits.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/engine/axis_demands.h"
#include "sim/evaluation/comparison.h"
#include "sim/preparation/prepared_case.h"

namespace servomill::sim::run {

/// Demands of the axes that the machine has, with their limits and the lines of the program.
std::vector<evaluation::AxisDemand> demands_of(const preparation::PreparedParts& one,
                                               const engine::AxisDemands& demands);

/// Limits that path and offset together exceed by more than 1 %, by how much and where; nullopt:
/// none.
std::optional<std::string> note_of_demands(const preparation::PreparedParts& one,
                                           const std::vector<evaluation::AxisDemand>& demands);

}  // namespace servomill::sim::run
