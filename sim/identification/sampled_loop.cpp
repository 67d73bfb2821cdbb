#include "sim/identification/sampled_loop.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace servomill::sim::identification {

SampledLoop::SampledLoop(const std::vector<LoopSettings>& lanes) : lanes_(lanes) {
  assert(!lanes.empty() && lanes.size() <= kLaneWidth);
}

void SampledLoop::start(std::size_t lane, double position, double speed, double force) {
  const LoopSettings& loop = lanes_[lane];
  // sample() writes the reading of the instant 0 at place 0: these are the ones before it
  for (std::size_t back = 1; back < past_readings_.size(); ++back) {
    // Extrapolated backwards with the speed at the start, so that the first differences are that
    // speed.
    past_readings_[past_readings_.size() - back][lane] =
        position - speed * loop.period * static_cast<double>(back);
  }
  newest_ = past_readings_.size() - 1;
  const double held = std::isnan(force) ? 0.0 : force;
  for (LaneArray& past : past_) past[lane] = held;
  latest_[lane] = held;
  integral_[lane] = 0.0;
  first_force_[lane] = force;
  filters_[lane] = controllers::standing_at(loop.filters, held);
  first_ = true;
}

void SampledLoop::remember(const LaneArray& force) {
  std::copy_backward(past_.begin(), past_.end() - 1, past_.end());
  past_.front() = latest_ = force;
}

void SampledLoop::force_sample(const LaneArray& force) {
  if (first_) past_.fill(force);
  first_ = false;
  remember(force);
}

void SampledLoop::sample(double q, double dq, double ddq, const LaneArray& feedback,
                         const LaneArray& motor) {
  const std::size_t places = past_readings_.size();
  newest_ = (newest_ + 1) % places;
  LaneArray force{};
  for (std::size_t l = 0; l < lanes_.size(); ++l) {
    const LoopSettings& loop = lanes_[l];
    const auto taps = static_cast<std::size_t>(loop.mean_of);
    // the difference of two means is that of their ends
    double& reading = past_readings_[newest_][l];
    reading = loop.speed_feedback == SpeedFeedback::motor ? motor[l] : feedback[l];
    const double way = reading - past_readings_[(newest_ + places - taps) % places][l];
    const double speed = way / (loop.period * static_cast<double>(taps));
    const double v_cmd = loop.Kv * (q - feedback[l]) + loop.kvf * dq;
    const double error = loop.Kp * (v_cmd - speed);
    // P or PI on the speed error, in units of force at the slide.
    const double wanted = error + integral_[l] + loop.kaf * ddq;
    const double limited = std::clamp(wanted, -loop.F_max, loop.F_max);
    force[l] = std::clamp(controllers::advance(loop.filters, filters_[l], limited), -loop.F_max,
                          loop.F_max);
    const bool has_reset = std::isfinite(loop.Tn);
    if (first_ && !std::isnan(first_force_[l])) {
      // the readings and the integral before it are not known, their result is
      if (has_reset) integral_[l] += first_force_[l] - wanted;
      force[l] = first_force_[l];
    }
    // Anti-windup: the integral waits while the force is limited.
    if (has_reset && std::abs(wanted) <= loop.F_max) integral_[l] += error * loop.period / loop.Tn;
  }
  first_ = false;
  remember(force);
}

void SampledLoop::set_parts(int parts) {
  shares_.clear();
  for (int part = 0; part < parts; ++part) {
    for (std::size_t n = 0; n < past_.size(); ++n) {
      Share share{static_cast<std::size_t>(part), n, {}};
      double any = 0.0;
      for (std::size_t l = 0; l < lanes_.size(); ++l) {
        const double delay = lanes_[l].dead_time / lanes_[l].period;
        // past_[n] was computed n periods ago and acts within [delay - n, delay - n + 1)
        const double begin = static_cast<double>(part) / parts - delay;
        const double end = static_cast<double>(part + 1) / parts - delay;
        const double acts = -static_cast<double>(n);
        const double within = std::min(end, acts + 1.0) - std::max(begin, acts);
        // Overlap of two intervals in periods, over the length 1/parts of the part: a dead time of
        // any length, not of whole periods alone, by the mean force over each part.
        any += share.weight[l] = std::max(within, 0.0) * parts;
      }
      if (any > 0.0) shares_.push_back(share);
    }
  }
}

LaneArray SampledLoop::acting(int part) const {
  LaneArray force{};
  for (const Share& share : shares_) {
    if (share.part != static_cast<std::size_t>(part)) continue;
    for (std::size_t l = 0; l < kLaneWidth; ++l) force[l] += share.weight[l] * past_[share.n][l];
  }
  return force;
}

}  // namespace servomill::sim::identification
