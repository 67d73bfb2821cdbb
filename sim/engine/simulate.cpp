#include "sim/engine/simulate.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "sim/engine/ideal_run.h"
#include "sim/engine/lockstep.h"

namespace servomill::sim::engine {

bool share_lanes(const CaseInputs& a, const CaseInputs& b) {
  const auto same_rate = [](const model::Rate& one, const model::Rate& other) {
    return one.due == other.due && one.period == other.period && one.phase == other.phase;
  };
  const std::vector<model::Rate> of_a = rates_of(a), of_b = rates_of(b);
  return a.servo == model::ServoModel::cascade && b.servo == model::ServoModel::cascade &&
         a.machine.integrator == b.machine.integrator &&
         a.machine.nc.periods.base == b.machine.nc.periods.base &&
         a.machine.joints() == b.machine.joints() &&
         std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), same_rate);
}

std::vector<CaseResult> simulate(std::span<CaseInputs* const> together, const StopFlag& stop,
                                 std::atomic<float>& progress, plant::PreparedDrives* kept) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<CaseResult> results;
  if (together.front()->servo == model::ServoModel::ideal) {
    results.push_back(IdealRun(*together.front()).run(stop, progress));
  } else {
    results = Lockstep(together, kept).run(stop, progress);
  }
  const double wall_time =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (CaseResult& result : results) result.wall_time = wall_time;
  return results;
}

CaseResult simulate(CaseInputs& inputs, const StopFlag& stop, std::atomic<float>& progress) {
  CaseInputs* const alone[] = {&inputs};
  return std::move(simulate(alone, stop, progress).front());
}

}  // namespace servomill::sim::engine
