/// Runs the points of a sweep on several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sim/run/point_batch.h"

namespace servomill::sim::sweep {

class Sweep;       // sim/sweep/sweep.h
struct Selection;  // sim/sweep/selection.h

/// One point that was run.
struct SweepPoint {
  std::uint64_t index = 0;          // counted from 0
  std::vector<std::string> values;  // TOML, for each key
  run::BatchResult result;
};

/// Most points that are run together.
inline constexpr std::size_t kBatchPoints = 16;

struct SweepControl {
  unsigned threads = 0;              // 0: as many as there are cores
  std::size_t batch = kBatchPoints;  // at least 1
  const engine::StopFlag* stop = nullptr;
  run::Keep keep = run::Keep::comparison;
  /// Points that ended, as soon and in the order in which they do; called from one thread. What it
  /// throws ends the sweep.
  std::function<void(std::vector<SweepPoint>&&)> batch_done;
};

/// Runs the points of a selection that are not done, in batches of neighbours. The result of a
/// point depends neither on the batches nor on the number of threads. A fault at a point is its
/// result.
/// @param done  by place in the selection
void run_sweep(const Sweep& sweep, const Selection& selection, const std::vector<bool>& done,
               const SweepControl& control);

}  // namespace servomill::sim::sweep
