#include "sim/engine/feedback_lanes.h"

#include <algorithm>
#include <cassert>

namespace servomill::sim::engine {

void FeedbackLanes::add(std::size_t run, const strategies::Strategy& strategy,
                        double model_period) {
  auto together = std::find_if(all_.begin(), all_.end(),
                               [&](const Together& one) { return one.strategy == &strategy; });
  if (together == all_.end()) {
    all_.push_back({&strategy, strategy.feedback(model_period)});
    together = all_.end() - 1;
    observes_ |= together->part->observes();
  }
  place_.at(run - first_) = static_cast<std::size_t>(together - all_.begin());
  use(*together, run - first_, true);
  model_period_ = model_period;
}

void FeedbackLanes::use(Together& together, std::size_t lane, bool used) {
  together.lanes.at(lane) = used;
  together.count = 0;
  for (std::size_t n = 0; n < kLaneWidth; ++n) {
    if (!together.lanes[n]) continue;
    ++together.count;
    together.last = n;
  }
}

FeedbackLanes::Together& FeedbackLanes::of(std::size_t run) {
  Together& together = all_[place_.at(run - first_)];
  assert(together.lanes.at(run - first_));
  return together;
}

void FeedbackLanes::set_reference(std::size_t run, const AxisSetpoint& set, double s) {
  if (!observes_) return;
  strategies::Reading& reading = readings_[run - first_];
  reading.s = s;
  reading.Q_ref = set.Q_ref;
  reading.dQ_ref = set.dQ_ff;
  reading.ddQ_ref = set.ddQ_ff;
  reading.Q_cmd = set.Q_cmd;
}

Joints FeedbackLanes::settle(std::size_t run, const Joints& Q_meas) {
  strategies::FeedbackPart& part = *of(run).part;
  if (part.observes()) {
    strategies::Reading& reading = readings_[run - first_];
    reading.Q_fb = Q_meas;
    part.observe(reading, run - first_);
  }
  return part.settle(Q_meas, run - first_);
}

std::string_view FeedbackLanes::failure(std::size_t run) {
  return of(run).part->failure(run - first_);
}

void FeedbackLanes::observe(Together& together) {
  for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
    if (!together.lanes[lane]) continue;
    strategies::Reading& reading = readings_[lane];
    reading.t = static_cast<double>(periods_) * model_period_;
    reading.Q_fb = axes_.Q_meas(first_ + lane);
    together.part->observe(reading, lane);
  }
}

std::vector<strategies::Saturation> FeedbackLanes::drop(std::size_t run) {
  Together& together = of(run);
  if (together.waiting > 0)
    apply_virtual_displacements(together);  // its own: periods that have passed
  use(together, run - first_, false);
  return together.part->saturations(run - first_);
}

void FeedbackLanes::evaluate_error_models() {
  bool are_read = false;
  for (Together& together : all_) {
    if (together.count == 0) continue;
    if (together.part->observes()) observe(together);
    if (together.count == 1) {
      wait(together);
      continue;
    }
    if (!are_read) axes_.get_readings(Q_meas_, first_);
    are_read = true;
    together.d = &together.part->advance(Q_meas_, together.lanes);
  }
  ++periods_;
}

void FeedbackLanes::wait(Together& one) {
  const Joints Q_meas = axes_.Q_meas(first_ + one.last);
  for (int j = 0; j < kJoints; ++j) one.Q_waiting[j][one.waiting] = Q_meas[j];
  if (++one.waiting == kLaneWidth) apply_virtual_displacements(one);
}

void FeedbackLanes::apply_virtual_displacements() {
  for (Together& together : all_) apply_virtual_displacements(together);
}

void FeedbackLanes::apply_virtual_displacements(Together& together) {
  if (together.d != nullptr) {
    axes_.displace(*together.d, together.lanes, together.strategy->displaces_rotary(), first_);
    together.d = nullptr;
  }
  if (together.waiting > 0) {
    axes_.displace(together.part->advance(together.Q_waiting, together.waiting, together.last),
                   first_ + together.last);
    together.waiting = 0;
  }
}

}  // namespace servomill::sim::engine
