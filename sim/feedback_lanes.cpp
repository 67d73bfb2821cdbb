#include "sim/feedback_lanes.h"

#include <algorithm>
#include <cassert>

namespace servomill::sim {

void FeedbackLanes::add(std::size_t run, const strategies::Strategy& strategy,
                        double model_period) {
  auto together = std::find_if(all_.begin(), all_.end(),
                               [&](const Together& one) { return one.strategy == &strategy; });
  if (together == all_.end()) {
    all_.push_back({&strategy, strategy.feedback(model_period)});
    together = all_.end() - 1;
  }
  use(*together, run - first_, true);
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
  const auto found = std::find_if(all_.begin(), all_.end(), [&](const Together& together) {
    return together.lanes.at(run - first_);
  });
  assert(found != all_.end());
  return *found;
}

Joints FeedbackLanes::settle(std::size_t run, const Joints& Q_meas) {
  return of(run).part->settle(Q_meas, run - first_);
}

void FeedbackLanes::drop(std::size_t run) { use(of(run), run - first_, false); }

void FeedbackLanes::advance() {
  bool are_read = false;
  for (Together& together : all_) {
    if (together.count == 0) continue;
    if (together.count == 1) {
      advance_one(together);
      continue;
    }
    if (!are_read) axes_.get_readings(Q_meas_, first_);
    are_read = true;
    axes_.displace(together.part->advance(Q_meas_, together.lanes), together.lanes,
                   together.strategy->displaces_rotary(), first_);
  }
}

void FeedbackLanes::advance_one(Together& one) {
  const std::size_t run = first_ + one.last;
  axes_.displace(one.part->advance(axes_.Q_meas(run), one.last), run);
}

}  // namespace servomill::sim
