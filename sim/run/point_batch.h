/// Several points of a sweep, run together.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sim/engine/stop_flag.h"
#include "sim/model/forward.h"
#include "sim/run/point_result.h"

namespace servomill {
class InputError;
}  // namespace servomill
namespace servomill::sim::preparation {
struct PreparationCache;
}

namespace servomill::sim::run {

/// A point of a batch, by its place there, that has ended.
struct EndedPoint {
  std::size_t place = 0;
  BatchResult result;
};

/// Rows of recorded signals, of all its runs together, that each of some threads may hold: a
/// quarter of the machine's memory is theirs, up to kMaxRows (some 2 GB) a thread: eight long
/// points fill the lanes.
double rows_at_once(unsigned threads);
inline constexpr double kMaxRows = 4e6;

struct BatchControl {
  Keep keep = Keep::comparison;
  preparation::PreparationCache* cache =
      nullptr;             // what preparing points shares, with other batches too
  double rows = kMaxRows;  // that may be held; one point is always run
};

/// Prepares and runs all cases of all points on the calling thread, in lockstep where they share
/// lanes (sim/engine/case_result.h). The result of a point depends on that point alone, bit for
/// bit. Faults of a point are part of its result; nothing is thrown but what `ended` throws.
/// @param stop      points that have not ended when it is set are never reported
/// @param progress  set to the share done of the batch, 0 to 1
/// @param ended     called on this thread with points as soon as they have ended, each once
void run_batch(std::span<const model::Scenario> points, const engine::StopFlag& stop,
               std::atomic<float>& progress,
               const std::function<void(std::vector<EndedPoint>&&)>& ended,
               const BatchControl& control = {});

/// All faults in one line; without their places where these are keys of a sweep.
std::string in_one_line(const InputError& error);

}  // namespace servomill::sim::run
