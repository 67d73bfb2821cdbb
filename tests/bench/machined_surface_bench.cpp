/// Targets on the surface that 10^6 positions of a cutter left, 33 um from each other: passes of
/// 180 mm over a wavy surface, 0.2 mm apart. `index` makes the index, `meet/targets/threads` meets
/// targets that are spread over the surface; items are targets.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "plant/cutting/machined_surface.h"

namespace servomill::plant {
namespace {

using Eigen::Vector3d;

constexpr int kPasses = 183, kPositions = 5465;  // a pass
constexpr double kStep = 33e-6, kApart = 0.2e-3, kLength = kStep * (kPositions - 1);

struct Part {
  Cutter cutter;
  bool turns;  // the axis, with the normal
};

const Part kParts[] = {
    {{.radius = 4e-3, .corner_radius = 4e-3, .length = 30e-3}, false},
    {{.radius = 4e-3, .corner_radius = 4e-3, .length = 30e-3}, true},
    {{.radius = 4e-3, .corner_radius = 1e-3, .length = 30e-3}, true},
    {{.radius = 4e-3, .length = 30e-3}, true},
};

constexpr double kWave = 2e-3, kNumber = 60.0;  // m, rad/m

Vector3d surface(double x, double y) {
  return {x, y, kWave * std::sin(kNumber * x) * std::cos(kNumber * y)};
}

Vector3d normal(double x, double y) {
  return Vector3d(-kWave * kNumber * std::cos(kNumber * x) * std::cos(kNumber * y),
                  kWave * kNumber * std::sin(kNumber * x) * std::sin(kNumber * y), 1.0)
      .normalized();
}

// There and back, as a finishing cut goes.
std::vector<CutterPass> passes(const Part& part) {
  CutterPass pass{part.cutter, {}};
  for (int j = 0; j < kPasses; ++j) {
    for (int i = 0; i < kPositions; ++i) {
      const double x = kStep * (j % 2 == 0 ? i : kPositions - 1 - i), y = kApart * j;
      const Vector3d n = normal(x, y), k = part.turns ? n : Vector3d::UnitZ();
      const double r = part.cutter.corner_radius;
      pass.positions.push_back({surface(x, y) + r * (n - k), k});
    }
  }
  return {pass};
}

std::vector<ProbeTarget> targets(std::size_t count) {
  std::vector<ProbeTarget> all;
  for (std::size_t i = 0; i < count; ++i) {
    // evenly over the surface, without a pattern
    const double u = std::fmod(0.7548776662466927 * static_cast<double>(i), 1.0);
    const double v = std::fmod(0.5698402909980532 * static_cast<double>(i), 1.0);
    const double x = kLength * (0.05 + 0.9 * u), y = kApart * kPasses * (0.2 + 0.6 * v);
    all.push_back({surface(x, y), normal(x, y)});
  }
  return all;
}

const MachinedSurface& machined(std::size_t part) {
  static std::vector<MachinedSurface> made;
  static std::size_t made_for = 0;
  if (made.empty() || made_for != part) {
    made.clear();
    made.emplace_back(passes(kParts[part]));
    made_for = part;
  }
  return made.front();
}

void make_index(benchmark::State& state, std::size_t part) {
  const auto all = passes(kParts[part]);
  for (auto _ : state) benchmark::DoNotOptimize(MachinedSurface(all).removed().position_count());
  state.SetItemsProcessed(state.iterations() * kPasses * kPositions);
}

void meet(benchmark::State& state, std::size_t part) {
  const MachinedSurface& surface_of_part = machined(part);
  const auto all = targets(static_cast<std::size_t>(state.range(0)));
  std::size_t missed = 0;
  for (auto _ : state) {
    for (const Meeting& meeting :
         surface_of_part.meet(all, 1e-3, 1e-3, static_cast<unsigned>(state.range(1)))) {
      if (meeting.kind != Meeting::Kind::met) ++missed;
    }
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.counters["missed"] = static_cast<double>(missed);
}

#define SERVOMILL_PART(name, number)                                          \
  BENCHMARK_CAPTURE(make_index, name, number)->Unit(benchmark::kMillisecond); \
  BENCHMARK_CAPTURE(meet, name, number)                                       \
      ->Args({1'000, 1})                                                      \
      ->Args({10'000, 1})                                                     \
      ->Args({100'000, 1})                                                    \
      ->Args({100'000, 2})                                                    \
      ->UseRealTime()                                                         \
      ->Unit(benchmark::kMillisecond)
SERVOMILL_PART(ball, 0);
SERVOMILL_PART(ball_turning, 1);
SERVOMILL_PART(bull_nose_turning, 2);
SERVOMILL_PART(flat_turning, 3);

}  // namespace
}  // namespace servomill::plant
