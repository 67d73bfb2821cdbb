/// A recording simulated under the loops of the machine's own NC: the engine's servo axes, with
/// filters, feed-forward, compensation of friction and backlash, current loops and their periods.
#pragma once

#include <span>

#include "sim/identification/record.h"
#include "sim/identification/simulate_record.h"

namespace servomill::sim::identification {

/// Command between two samples of a record: cubic between them, by their neighbours.
struct CommandBetween {
  double q = 0.0, dq = 0.0, ddq = 0.0;  // m, m/s, m/s^2 or rad
};
/// @param share  0 to 1, from sample k to the next
CommandBetween command_between(const Record& record, std::size_t k, double share);

/// Simulates up to eight models of LoopKind::nc, at rest before the record begins.
/// @pre the period of the record is a whole multiple of the NC's position period
void simulate_nc(const Record& record, std::span<const AxisModel> models, std::span<Simulated> out);

}  // namespace servomill::sim::identification
