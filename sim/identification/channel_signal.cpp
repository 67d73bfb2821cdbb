#include "sim/identification/channel_signal.h"

#include <algorithm>
#include <cmath>

namespace servomill::sim::identification {

ChannelSignal::ChannelSignal(const recordings::Channel& channel, const recordings::Base& base,
                             const ChannelUse& use, double time_factor)
    : delay_(use.delay) {
  for (std::size_t k = 0; k < channel.samples.size(); ++k) {
    if (std::isnan(channel.samples[k])) continue;
    t_.push_back(base.values[k] * time_factor);
    y_.push_back(use.factor * channel.samples[k] + use.offset);
  }
}

void ChannelSignal::find(double t) {
  while (at_ > 0 && t_[at_] > t) --at_;
  while (at_ + 1 < t_.size() && t_[at_ + 1] <= t) ++at_;
}

double ChannelSignal::gap(double t) {
  find(t + delay_);
  return at_ + 1 < t_.size() ? t_[at_ + 1] - t_[at_] : 0.0;
}

double ChannelSignal::operator()(double t) {
  t += delay_;
  find(t);
  if (at_ + 1 >= t_.size()) return y_.back();
  const double share = std::clamp((t - t_[at_]) / (t_[at_ + 1] - t_[at_]), 0.0, 1.0);
  return share == 0.0 ? y_[at_] : y_[at_] + share * (y_[at_ + 1] - y_[at_]);
}

}  // namespace servomill::sim::identification
