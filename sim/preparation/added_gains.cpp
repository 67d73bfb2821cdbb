#include "sim/preparation/added_gains.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/frequency/added_gain.h"
#include "sim/frequency/stability.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/stability_check.h"

namespace servomill::sim::preparation {
namespace {

// The open position loops of X, Y and Z of a case.
class LinearLoops {
 public:
  LinearLoops(const model::Scenario& scenario, const model::CaseSpec& spec, PreparationCache& cache)
      : linear_(frequency::linearised(scenario.machine_of(spec))),
        delay_(scenario.reading_delay_of(spec)),
        cache_(cache) {}

  std::vector<int> joints() const {
    std::vector<int> out;
    for (const int j : linear_.joints()) {
      if (j < kLinearJoints) out.push_back(j);
    }
    return out;
  }
  double Kv(int joint) const { return linear_.nc.cascade[static_cast<std::size_t>(joint)].Kv; }
  char letter(int joint) const { return linear_.chain.layout.letter_of(joint); }
  bool is_checked() const { return linear_.nc.check_stability; }

  /// True if the sampled loop settles with C (1/s) added to Kv.
  bool is_stable(int joint, double C) const {
    model::MachineSettings with = linear_;
    with.nc.cascade[static_cast<std::size_t>(joint)].Kv += C;
    return spectral_radius(with, joint, delay_, &cache_) < 1.0;
  }

  std::shared_ptr<const frequency::Curve> open(int joint) const {
    system::MemoKey key;
    key.add(delay_);
    add_linear_axis(key, linear_, joint);
    return cache_.open_loops.get(
        key, [&] { return frequency::open_position_loop(linear_, joint, delay_); });
  }

 private:
  const model::MachineSettings linear_;
  Tick delay_;
  PreparationCache& cache_;
};

double decibels(double factor) { return 20.0 * std::log10(factor); }

}  // namespace

double largest_added_gain(const model::Scenario& scenario, const model::CaseSpec& spec,
                          const WantedMargins& wanted, PreparationCache& cache) {
  const LinearLoops loops(scenario, spec, cache);
  double least = std::numeric_limits<double>::infinity(), largest_Kv = 0.0;
  for (const int j : loops.joints()) largest_Kv = std::max(largest_Kv, loops.Kv(j));
  for (const int j : loops.joints()) {
    least = std::min(
        least, frequency::largest_added_gain(*loops.open(j), loops.Kv(j), largest_Kv, wanted));
  }
  return least;
}

std::vector<std::string> check_added_gain(const model::Scenario& scenario,
                                          const model::CaseSpec& spec,
                                          const model::StrategySpec& strategy,
                                          const AddedGain& added, PreparationCache& cache) {
  constexpr double kRounding = 1e-3;
  const WantedMargins usual;
  const LinearLoops loops(scenario, spec, cache);
  std::vector<std::string> notes;
  if (added.C == 0.0) return notes;
  if (spec.servo == model::ServoModel::ideal) {
    return {
        fmt::format("warning: case {}: strategy {} acts in the position loops, which an ideal "
                    "servo does not have",
                    spec.name, strategy.entry->name)};
  }
  for (const int j : loops.joints()) {
    const auto margins = frequency::margins_with(*loops.open(j), loops.Kv(j), added);
    const std::string what = fmt::format(
        "case {}: strategy {}: with {:.4g} 1/s added to Kv = {:.4g} 1/s the position loop "
        "of {}",
        spec.name, strategy.entry->name, added.C, loops.Kv(j), loops.letter(j));
    // of an integral part the margins tell, as far as there is a crossover
    if (loops.is_checked() && (!loops.is_stable(j, added.C) || margins.phase <= 0.0)) {
      throw InputError(strategy.place,
                       what +
                           " is unstable; lower the gain, or set nc.check_stability = false to "
                           "simulate it anyway");
    }
    if (margins.gain > usual.gain * (1.0 - kRounding) && margins.phase > usual.phase - kRounding) {
      continue;
    }
    notes.push_back(
        fmt::format("warning: {} has a phase margin of {:.1f} deg and a gain margin of "
                    "{:.1f} dB; usual are 45 deg and 6 dB",
                    what, margins.phase / deg, decibels(margins.gain)));
  }
  return notes;
}

}  // namespace servomill::sim::preparation
