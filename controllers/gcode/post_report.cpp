#include "controllers/gcode/post_report.h"

#include <fmt/format.h>

#include <utility>

#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr std::size_t kMaxFaults = 20;

}  // namespace

void PostReport::fault(int line, std::string message) {
  faults_.push_back({{file_, line, 0}, std::move(message)});
}

void PostReport::warn(int line, std::string message) {
  warnings_.push_back({{file_, line, 0}, std::move(message)});
}

bool PostReport::is_full() const { return faults_.size() >= kMaxFaults; }

void PostReport::note_singular(int line) {
  if (singular_++ == 0) first_singular_ = line;
}

void PostReport::note_bend(int line, double deviation) {
  ++bent_;
  if (deviation <= bend_) return;
  bend_ = deviation;
  most_bent_ = line;
}

void PostReport::note_slowed(const std::vector<FeedReduction>& joints) {
  ++slowed_blocks_;
  for (const FeedReduction& here : joints) {
    if (!slowed_ || here.share() < slowed_->share()) slowed_ = here;
  }
}

void PostReport::sum_up() {
  if (singular_ > 0) {
    warn(first_singular_, fmt::format("the tool axis is in a singular direction, here and at {} "
                                      "other locations: a rotary axis is undetermined",
                                      singular_ - 1));
  }
  if (bent_ > 0) {
    const std::string more =
        bent_ == 1 ? "" : fmt::format(", and exceeds the tolerance on {} other moves", bent_ - 1);
    warn(most_bent_, fmt::format("between the previous location and this one the TCP deviates from "
                                 "the straight line by {:.4g} mm{}; --classical inserts no points",
                                 bend_ / mm, more));
  }
  if (slowed_) {
    slowed_->others = slowed_blocks_ - 1;
    warn(slowed_->line, to_string(*slowed_, layout_));
  }
}

std::vector<Warning> PostReport::conclude(std::vector<Warning>* of_refused) {
  sum_up();
  if (faults_.empty()) return std::move(warnings_);
  if (of_refused != nullptr) {
    of_refused->insert(of_refused->end(), warnings_.begin(), warnings_.end());
  }
  throw InputError(std::move(faults_));
}

}  // namespace servomill::controllers
