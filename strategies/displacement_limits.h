/// Limits of virtual displacements over several model periods, and what they did in a run.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "plant/vocabulary/lanes.h"
#include "strategies/approach_kernel.h"
#include "strategies/strategy.h"

namespace servomill::strategies {

/// Model periods in which displacements were limited: of each joint and run.
template <int kDisplaced>
class HeldPeriods {
 public:
  explicit HeldPeriods(double period) : period_(period) {}

  void settle(std::size_t run) {
    now_[run] = 0;
    for (auto& joint : held_) joint[run] = {};
  }
  /// The displacement of one joint n periods after the last that has passed.
  void look(int joint, std::size_t run, std::size_t n, double wanted, double value, double most) {
    if (value == wanted) return;
    Held& held = held_[static_cast<std::size_t>(joint)][run][std::abs(wanted) > most ? 0 : 1];
    if (held.periods++ == 0) held.first = now_[run] + n;
  }
  void pass(std::size_t run, std::size_t periods) { now_[run] += periods; }

  std::vector<Saturation> all(std::size_t run, const Joints& most, const Joints& most_rate) const {
    std::vector<Saturation> out;
    for (int j = 0; j < kDisplaced; ++j) {
      for (const bool of_rate : {false, true}) {
        const Held& held = held_[static_cast<std::size_t>(j)][run][of_rate ? 1 : 0];
        if (held.periods == 0) continue;
        out.push_back({j, of_rate, of_rate ? most_rate[j] : most[j],
                       static_cast<double>(held.first) * period_,
                       static_cast<double>(held.periods) * period_});
      }
    }
    return out;
  }

 private:
  struct Held {
    std::size_t first = 0, periods = 0;
  };
  double period_;                              // s
  std::array<std::size_t, kLaneWidth> now_{};  // periods that have passed
  std::array<std::array<std::array<Held, 2>, kLaneWidth>, kDisplaced> held_{};  // size, rate
};

/// approached() period by period: of what was wanted, then of all but the last of `next`, which is
/// wanted from then on. Where no limit is felt on the way, that is the last but one.
/// @param held  called with the number of the period, what was wanted and what became of it, of
///              periods that may have felt a limit
template <class Held>
double approach_in_turn(const LaneArray& next, std::size_t periods, double most, double most_change,
                        double& wanted, double& value, Held held) {
  double low = std::min(wanted, value), high = std::max(wanted, value);
  for (std::size_t n = 0; n + 1 < periods; ++n) {
    low = std::min(low, next[n]);
    high = std::max(high, next[n]);
  }
  constexpr double kBelowLimit = 0.99;  // no rounding leads beyond
  if (high - low <= kBelowLimit * most_change && -most <= low && high <= most) {
    value = periods > 1 ? next[periods - 2] : wanted;
    wanted = next[periods - 1];
    return value;
  }
  for (std::size_t n = 0; n < periods; ++n) {
    value = approached(wanted, most, most_change, value);
    held(n, wanted, value);
    wanted = next[n];
  }
  return value;
}

}  // namespace servomill::strategies
