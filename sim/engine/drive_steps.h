/// Rates of the loops of a machine, and the steps of its drives between the instants of a schedule.
#pragma once

#include <cstddef>
#include <vector>

#include "plant/drives/prepared_drives.h"
#include "sim/model/forward.h"
#include "sim/model/schedule.h"

namespace servomill::sim::engine {

/// When the loops of a machine are due.
/// @param reading_delay  ticks from the scale to what the position loop reads: kFeedbackSample is
///                       due so much before the position loop
std::vector<model::Rate> loop_rates(const model::LoopPeriods& periods, Tick reading_delay);

/// Sequence of drive steps over one schedule. A step may pass instants at which only the error
/// model is due; each of several ends at such an instant or at the next one.
struct DriveSteps {
  struct Leg {
    Tick step;
    int stretch = -1;  // with stops on the way; -1: none
  };
  std::vector<Leg> legs;
  std::vector<plant::Stretch> stretches;
  std::vector<Tick> steps;     // of the legs without stops
  std::size_t most_stops = 0;  // of a stretch
};
/// @param most_stops  on a stretch; 0: each stop ends a leg
DriveSteps drive_steps(const std::vector<model::Instant>& schedule, std::size_t most_stops = 8);

}  // namespace servomill::sim::engine
