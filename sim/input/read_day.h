/// Reads the day of a machine that warms up.
#pragma once

#include <memory>

#include "sim/config/reader.h"

namespace servomill::sim::model {
struct Scenario;
struct WorkingDay;
}  // namespace servomill::sim::model

namespace servomill::sim::input {

/// Table `day` of a scenario; nullptr if it has none. Faults: no machine with heat, places beyond
/// the travel, a datum at a place that there is not.
std::shared_ptr<const model::WorkingDay> read_day(config::Reader& root,
                                                  const model::Scenario& scenario);

}  // namespace servomill::sim::input
