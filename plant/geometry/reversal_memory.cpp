#include "plant/geometry/reversal_memory.h"

#include <algorithm>
#include <cassert>

namespace servomill::plant {

ReversalMemory::ReversalMemory(std::span<const Play> plays, const Joints& Q)
    : plays_(plays.begin(), plays.end()) {
  for (const Play& play : plays_) middle_.push_back(Q[play.joint]);
}

double ReversalMemory::middle_at(std::size_t n, double q) const {
  const double half = 0.5 * plays_[n].distance;
  return std::clamp(middle_[n], q - half, q + half);
}

void ReversalMemory::travel(const Joints& Q) {
  for (std::size_t n = 0; n < plays_.size(); ++n) middle_[n] = middle_at(n, Q[plays_[n].joint]);
}

void ReversalMemory::directions(const Joints& Q, std::span<double> out) const {
  assert(out.size() == plays_.size());
  for (std::size_t n = 0; n < plays_.size(); ++n) {
    const double q = Q[plays_[n].joint];
    const double u = (q - middle_at(n, q)) / (0.5 * plays_[n].distance);
    out[n] = direction_of(std::clamp(u, -1.0, 1.0));  // the quotient may be rounded beyond
  }
}

}  // namespace servomill::plant
