/// One channel of a recording as a signal over time, in SI.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/recordings/recording.h"

namespace servomill::sim::identification {

/// A channel with its role: SI = factor sample + offset, `delay` late.
struct ChannelUse {
  std::string channel;
  double factor = 1.0, offset = 0.0;
  double delay = 0.0;  // s
  bool present = false;
};

/// Samples of a channel at times that rise, by linear interpolation; missing ones are left out.
class ChannelSignal {
 public:
  /// @param time_factor  s, of one unit of the base
  ChannelSignal(const recordings::Channel& channel, const recordings::Base& base,
                const ChannelUse& use, double time_factor);

  bool empty() const { return t_.empty(); }
  /// Instants of the first and the last sample, less the delay (s). @pre !empty()
  double first() const { return t_.front() - delay_; }
  double last() const { return t_.back() - delay_; }
  /// Time from one sample to the next around t (s).
  double gap(double t);
  /// Value at t. @pre !empty()
  double operator()(double t);

 private:
  void find(double t);

  double delay_;
  std::vector<double> t_, y_;
  std::size_t at_ = 0;
};

}  // namespace servomill::sim::identification
