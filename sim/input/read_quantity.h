/// Reads the quantities that a scenario evaluates.
#pragma once

#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// One [[quantity]], added to those of `out`: of circles, ball bars and location errors one for
/// each of them. A quantity at fault in its name is left out.
/// @param out           all but its quantities has been read
/// @param checks_cases  names of cases are looked up; not where a case has no right name
void read_quantity(config::Reader& table, bool checks_cases, model::Scenario& out);

}  // namespace servomill::sim::input
