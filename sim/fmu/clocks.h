/// Clocks of FMI 3: they tick where the loops of the NC are sampled.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "sim/model/machine.h"

namespace servomill::sim::fmu {

struct Clock {
  std::uint32_t reference;  // FMI's value reference
  std::string_view name;
  Tick model::LoopPeriods::*period;
  std::string_view description;
};

/// Value reference of the first, behind the variables of the tool.
inline constexpr std::uint32_t kClockReference = 2000;

inline constexpr std::array<Clock, 3> kClocks = {{
    {kClockReference, "position_clock", &model::LoopPeriods::position,
     "ticks where the position loops sample setpoints and scales"},
    {kClockReference + 1, "velocity_clock", &model::LoopPeriods::velocity,
     "ticks where the velocity loops are sampled"},
    {kClockReference + 2, "current_clock", &model::LoopPeriods::current,
     "ticks where the current loops are sampled"},
}};

/// True if any clock ticks at that tick since the start.
inline bool any_ticks(const model::LoopPeriods& periods, Tick tick) {
  for (const Clock& clock : kClocks) {
    if (tick % (periods.*clock.period) == 0) return true;
  }
  return false;
}

/// First tick after `tick` at which any clock ticks.
inline Tick next_tick(const model::LoopPeriods& periods, Tick tick) {
  Tick next = tick + periods.position;
  for (const Clock& clock : kClocks) {
    const Tick period = periods.*clock.period;
    next = std::min(next, (tick / period + 1) * period);
  }
  return next;
}

}  // namespace servomill::sim::fmu
