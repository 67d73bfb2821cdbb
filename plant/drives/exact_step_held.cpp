#include <algorithm>
#include <bit>
#include <cstdint>

#include "plant/drives/exact_step.h"

namespace servomill::plant {

void ExactStep::prepare_held() {
  constexpr std::size_t kCommand = 4, kForce = 5, kEnd = Propagator::kNodes - 1;
  const Linear& linear = linear_.front();
  for (std::size_t level = 0; level < linear.ladder.size(); ++level) {
    const Propagator& P = linear.ladder[level];
    const BedPropagator& bed = linear.bed[level];
    Held& held = held_.emplace_back();
    const auto take = [&](std::size_t to, const auto& slide, const auto& at_bed) {
      std::array<double, Held::kRows>& column = held.columns[to];
      column[0] += slide[kEnd];
      for (std::size_t k = 0; k < 4; ++k) column[1 + k] += slide[Propagator::kCurrent + k];
      for (std::size_t k = 0; k < 2; ++k) column[5 + k] += at_bed[2 * kEnd + k];
    };
    for (std::size_t from = 0; from <= kCommand; ++from) take(from, P.slide[from], bed.bed[from]);
    for (std::size_t from = kForce; from < Propagator::kColumns; ++from) {
      take(kForce, P.slide[from], bed.bed[from]);
    }
    for (std::size_t n = 0; n < 2; ++n) {
      take(kForce + 1 + n, bed.slide[n], bed.bed[Propagator::kColumns + n]);
    }
  }
}

void ExactStep::advance_held(LaneState& s, double command, double force, std::int64_t steps) const {
  const int coarsest = static_cast<int>(held_.size()) - 1;
  while (steps > 0) {
    const int fits = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(steps))) - 1;
    const int level = std::min(coarsest, fits);
    steps -= std::int64_t{1} << level;
    const double from[] = {s.i, s.w, s.delta, s.v, command, force, s.bed_x, s.bed_v};
    std::array<double, Held::kRows> to{};
    for (std::size_t column = 0; column < Held::kColumns; ++column) {
      for (std::size_t row = 0; row < Held::kRows; ++row) {
        to[row] += held_[static_cast<std::size_t>(level)].columns[column][row] * from[column];
      }
    }
    s.v = to[0];
    s.i = to[1];
    s.w = to[2];
    s.delta = to[3];
    s.x += to[4];
    s.bed_x = to[5];
    s.bed_v = to[6];
  }
}

}  // namespace servomill::plant
