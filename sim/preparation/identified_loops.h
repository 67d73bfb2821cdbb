/// Position loops that a strategy is given to know (strategies/identified_loops.h).
#pragma once

#include <memory>

#include "plant/vocabulary/ticks.h"
#include "sim/model/forward.h"
#include "sim/system/shared_cache.h"
#include "strategies/identified_loops.h"

namespace servomill::sim::preparation {

struct PreparationCache;

/// Exact sampled responses of all axes, with friction and scales of the machine. Friction without
/// bristles gives way by kPresliding.
inline constexpr double kPresliding = 1e-6;  // m, rad, at the largest force
/// @param reading_delay  ticks between the scale and what the position loop reads
/// @param model_period   s, of the displacement: one passes before it acts, it is held for one
/// @param cache          of the responses
std::shared_ptr<const strategies::IdentifiedLoops> identified_loops(
    const model::MachineSettings& machine, Tick reading_delay, double model_period,
    PreparationCache& cache);

/// Adds them to a key, whose result shares their responses.
void add(system::MemoKey& key, const strategies::IdentifiedLoops& loops);

}  // namespace servomill::sim::preparation
