/// Time as an integer number of base ticks.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

namespace servomill {

/// Count of base ticks. Every rate of a run is a whole multiple of the base period, so that "is it
/// due" is a question about integers.
using Tick = std::int64_t;

/// The whole number of base periods in `duration` (s), or nullopt if it is not one within 1e-6.
inline std::optional<Tick> whole_ticks(double duration, double base_period) {
  const double ratio = duration / base_period;
  const double whole = std::round(ratio);
  if (!(std::abs(ratio - whole) <= 1e-6) || whole < 0.0) return std::nullopt;
  return static_cast<Tick>(whole);
}

}  // namespace servomill
