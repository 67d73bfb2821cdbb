#include "sim/run/case_pool.h"

#include <algorithm>
#include <utility>

namespace servomill::sim::run {

CasePool::CasePool(std::size_t count, unsigned threads, std::function<void(std::size_t)> run_case)
    : run_case_(std::move(run_case)), ended_(count), failures_(count) {
  try {
    for (std::size_t t = 0; t < std::min<std::size_t>(threads, count); ++t) {
      threads_.emplace_back([this] { work(); });
    }
  } catch (...) {  // those that there are wait for no further case
    next_ = count;
    throw;
  }
}

CasePool::~CasePool() { next_ = ended_.size(); }

void CasePool::work() {
  for (std::size_t i = next_++; i < ended_.size(); i = next_++) {
    try {
      run_case_(i);
    } catch (...) {
      failures_[i] = std::current_exception();
    }
    {
      const std::scoped_lock lock(mutex_);
      ended_[i] = true;
    }
    one_has_ended_.notify_all();
  }
}

bool CasePool::wait(std::size_t index, std::chrono::milliseconds most) {
  std::unique_lock lock(mutex_);
  return one_has_ended_.wait_for(lock, most, [&] { return static_cast<bool>(ended_[index]); });
}

bool CasePool::has_ended(std::size_t index) const {
  const std::scoped_lock lock(mutex_);
  return ended_[index];
}

}  // namespace servomill::sim::run
