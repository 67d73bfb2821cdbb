#include "plant/cutting/machined_surface.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <thread>

namespace servomill::plant {
namespace {

constexpr std::size_t kTargetsAtOnce = 64;  // of a thread

Meeting::Kind kind_of(FreeWay::Kind kind) {
  switch (kind) {
    case FreeWay::Kind::untouched:
      return Meeting::Kind::untouched;
    case FreeWay::Kind::blocked:
      return Meeting::Kind::blocked;
    case FreeWay::Kind::ends:
      return Meeting::Kind::met;
    case FreeWay::Kind::through:
      break;
  }
  return Meeting::Kind::through;
}

// Calls `work` for 0 .. count - 1, each once.
template <class Work>
void for_each_on_threads(std::size_t count, unsigned threads, const Work& work) {
  if (threads == 0) threads = std::max(std::thread::hardware_concurrency(), 1U);
  std::atomic<std::size_t> next = 0;
  const auto run = [&] {
    while (true) {
      const std::size_t begin = next.fetch_add(kTargetsAtOnce);
      if (begin >= count) return;
      for (std::size_t i = begin; i < std::min(begin + kTargetsAtOnce, count); ++i) work(i);
    }
  };
  std::vector<std::jthread> pool;
  for (std::size_t t = 1; t < threads && t * kTargetsAtOnce < count; ++t) pool.emplace_back(run);
  run();
}

}  // namespace

Meeting MachinedSurface::meet(const ProbeTarget& target, double clearance, double depth) const {
  assert(std::abs(target.normal.norm() - 1.0) < 1e-9 && clearance + depth > 0.0);
  const FreeWay way = removed_.free_way(
      {target.point + clearance * target.normal, -target.normal, clearance + depth});
  return {kind_of(way.kind), way.kind == FreeWay::Kind::ends ? clearance - way.end : 0.0,
          way.position};
}

std::vector<Meeting> MachinedSurface::meet(std::span<const ProbeTarget> targets, double clearance,
                                           double depth, unsigned threads) const {
  std::vector<Meeting> meetings(targets.size());
  for_each_on_threads(targets.size(), threads,
                      [&](std::size_t i) { meetings[i] = meet(targets[i], clearance, depth); });
  return meetings;
}

}  // namespace servomill::plant
