#include "controllers/servo/setpoint_correction.h"

#include <algorithm>
#include <cmath>

namespace servomill::controllers {

SetpointCorrection::SetpointCorrection(const SetpointEntry& entry, double position_period)
    : entry_(entry.entry),
      periods_per_update_(
          std::max(1, static_cast<int>(std::ceil(entry.update_period / position_period - 1e-9)))),
      gain_(entry.time_constant > 0.0 ? -std::expm1(-position_period / entry.time_constant) : 1.0),
      delayed_(static_cast<std::size_t>(std::lround(entry.dead_time / position_period)),
               Joints::Zero()) {}

void SetpointCorrection::settle(const Joints& value) {
  std::fill(delayed_.begin(), delayed_.end(), value);
  held_ = value;
  out_ = value;
}

Joints SetpointCorrection::advance(const Joints& value) {
  if (wants_value()) held_ = value;
  phase_ = phase_ + 1 == periods_per_update_ ? 0 : phase_ + 1;

  Joints u = held_;
  if (!delayed_.empty()) {
    std::swap(u, delayed_[oldest_]);
    oldest_ = oldest_ + 1 == delayed_.size() ? 0 : oldest_ + 1;
  }
  out_ += gain_ * (u - out_);
  return out_;
}

}  // namespace servomill::controllers
