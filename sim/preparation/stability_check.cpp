#include "sim/preparation/stability_check.h"

#include <fmt/format.h>

#include "sim/frequency/axis_dynamics.h"
#include "sim/frequency/frequency_response.h"
#include "sim/frequency/stability.h"
#include "sim/input/implausible.h"
#include "sim/preparation/preparation_cache.h"

namespace servomill::sim::preparation {
namespace {

constexpr double kMarginal = 1.0 + 1e-9;  // spectral radius, for rounding

// The innermost loop that is unstable by itself: its gain is the one to lower.
Fault instability(const model::MachineSettings& machine, int joint, double radius) {
  const auto j = static_cast<std::size_t>(joint);
  const model::GainPlaces& places = machine.nc.gain_place[j];
  const controllers::CascadeParams& cascade = machine.nc.cascade[j];
  const controllers::CurrentLoopParams& current = machine.nc.functions[j].current_loop;
  const plant::FeedDriveParams& drive = machine.drives[j];
  const char axis = machine.chain.layout.letter_of(joint);
  const std::string_view watch = "or set nc.check_stability = false to simulate it anyway";
  if (drive.has_winding() && !(current.Kp * current.Ti < 2.0 * drive.L)) {
    return {places.winding_bandwidth,
            fmt::format("axis {}: the current loop is unstable with winding.bandwidth = {:.4g} "
                        "rad/s; must be < {:.4g} rad/s at its period, {}",
                        axis, current.Kp / drive.L, 2.0 / current.Ti, watch)};
  }
  if (frequency::velocity_spectral_radius(machine, joint) >= kMarginal) {
    return {places.velocity_bandwidth,
            fmt::format("axis {}: the velocity loop is unstable with velocity_bandwidth = {:.4g} "
                        "rad/s over its current loop and filters; lower it or make them faster, "
                        "{}",
                        axis, cascade.Kp / cascade.J, watch)};
  }
  return {
      places.Kv,
      fmt::format("axis {}: the servo loop is unstable with Kv = {:.4g} 1/s over a stable "
                  "velocity loop of {:.4g} rad/s (grows by a factor of {:.6g} per period); lower "
                  "Kv or make the velocity loop faster, {}",
                  axis, cascade.Kv, cascade.Kp / cascade.J, radius, watch)};
}

}  // namespace

double spectral_radius(const model::MachineSettings& linear, int joint, Tick reading_delay,
                       PreparationCache* cache) {
  const auto compute = [&] { return frequency::spectral_radius(linear, joint, reading_delay); };
  if (cache == nullptr) return compute();
  system::MemoKey key;
  key.add(reading_delay);
  add_linear_axis(key, linear, joint);
  return *cache->spectral_radii.get(key, compute);
}

void check_stability(const model::MachineSettings& machine, Tick reading_delay,
                     PreparationCache* cache) {
  if (!machine.nc.check_stability) return;
  const model::MachineSettings linear = frequency::linearised(machine);
  std::vector<Fault> faults;
  for (const int j : machine.joints()) {
    const double radius = spectral_radius(linear, j, reading_delay, cache);
    if (radius < kMarginal) continue;
    faults.push_back(instability(machine, j, radius));
    for (const std::string& value : input::implausible_values(machine, j)) {
      faults.back().message += "; " + value;
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

}  // namespace servomill::sim::preparation
