/// Cases of a run on threads of their own.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace servomill::sim::run {

/// Cases are independent: any thread may run any of them. The destructor waits for those that run;
/// no further case begins.
class CasePool {
 public:
  /// @param run_case  called once for each index below `count`, by several threads
  CasePool(std::size_t count, unsigned threads, std::function<void(std::size_t)> run_case);
  ~CasePool();
  CasePool(const CasePool&) = delete;
  CasePool& operator=(const CasePool&) = delete;

  /// Waits until the case has ended, at most so long; returns whether it has.
  bool wait(std::size_t index, std::chrono::milliseconds most);
  bool has_ended(std::size_t index) const;
  /// Exception that ended the case; nullptr: none. @pre has_ended(index)
  const std::exception_ptr& failure(std::size_t index) const { return failures_[index]; }

 private:
  void work();

  const std::function<void(std::size_t)> run_case_;
  std::atomic<std::size_t> next_ = 0;
  mutable std::mutex mutex_;
  std::condition_variable one_has_ended_;
  std::vector<bool> ended_;
  std::vector<std::exception_ptr> failures_;
  std::vector<std::jthread> threads_;  // last: they use the others
};

}  // namespace servomill::sim::run
