#include "plant/vocabulary/progress.h"

#include <algorithm>

namespace servomill {
namespace {

thread_local ProgressWatch* watch_of_thread = nullptr;

}  // namespace

double share_done(const std::vector<StageState>& stages) {
  double share = 0.0;
  for (auto stage = stages.rbegin(); stage != stages.rend(); ++stage) {  // the innermost first
    share = stage->total > 0.0 ? std::min(1.0, (stage->done + share) / stage->total) : 0.0;
  }
  return share;
}

Stage::Stage(std::string_view counted, double total, Steps steps, const std::atomic<float>* share)
    : counted_(counted),
      total_(total),
      steps_(steps),
      begin_(std::chrono::steady_clock::now()),
      share_(share),
      watch_(ProgressWatch::of_this_thread()) {
  if (watch_ == nullptr) return;
  const std::scoped_lock lock(watch_->mutex_);
  watch_->stages_.push_back(this);
}

Stage::~Stage() {
  if (watch_ == nullptr) return;
  const std::scoped_lock lock(watch_->mutex_);
  std::erase(watch_->stages_, this);
}

StageState Stage::state() const {
  const double done = share_ != nullptr ? double(share_->load(std::memory_order_relaxed))
                                        : done_.load(std::memory_order_relaxed);
  const auto now = std::chrono::steady_clock::now();
  return {counted_, total_ > 0.0 ? std::min(done, total_) : done, total_, steps_,
          std::chrono::duration<double>(now - begin_).count()};
}

ProgressWatch::ProgressWatch() : before_(watch_of_thread) { watch_of_thread = this; }

ProgressWatch::~ProgressWatch() { watch_of_thread = before_; }

std::vector<StageState> ProgressWatch::stages() const {
  const std::scoped_lock lock(mutex_);
  std::vector<StageState> out;
  for (const Stage* stage : stages_) out.push_back(stage->state());
  return out;
}

void ProgressWatch::forget() { watch_of_thread = nullptr; }

ProgressWatch* ProgressWatch::of_this_thread() { return watch_of_thread; }

}  // namespace servomill
