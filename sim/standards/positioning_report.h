/// Report of a positioning test (ISO 230-2).
#pragma once

#include <optional>

#include "sim/standards/positioning_readings.h"
#include "sim/standards/positioning_uncertainty.h"
#include "sim/standards/report.h"

namespace servomill::sim::standards {

/// Contributions to the uncertainty and how they are propagated.
struct UncertaintyInput {
  PositioningContributions contributions;
  MonteCarloSettings settings;
};

/// @param uncertainty  none: the report says that U is not stated
Report positioning_report(const PositioningFile& file,
                          const std::optional<UncertaintyInput>& uncertainty);

/// Adds the periodic positioning error of each direction.
/// @pre why_no_period(test, period) is nullopt
void add_periodic_error(const PositioningTest& test, double period, Report& report);

}  // namespace servomill::sim::standards
