/// Fundamentals of the signals of an axis.
#pragma once

#include <array>
#include <complex>

#include "sim/frequency/axis_test_bench.h"

namespace servomill::sim::frequency {

/// Mean of y(t) exp(-j w t) over the instants at which each signal exists: every base tick, or
/// those of its loop.
class Fundamental {
 public:
  /// @param turn  exp(-j w t)
  void add(std::uint8_t due, const AxisSignals& y, Complex turn) {
    for (std::size_t s = 0; s < kAxisSignals; ++s) {
      const std::uint8_t loop = sampled_by(static_cast<AxisSignal>(s));
      if (loop != 0 && !(due & loop)) continue;
      sum_[s] += y[s] * turn;
      ++count_[s];
    }
  }
  Response mean() const {
    Response out{};
    for (std::size_t s = 0; s < kAxisSignals; ++s) {
      if (count_[s] > 0) out[s] = sum_[s] / static_cast<double>(count_[s]);
    }
    return out;
  }

 private:
  Response sum_{};
  std::array<int, kAxisSignals> count_{};
};

}  // namespace servomill::sim::frequency
