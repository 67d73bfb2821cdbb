#include "sim/system/worker_thread.h"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

namespace servomill::sim::system {

WorkerThread::~WorkerThread() {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !job_; });
  }
  thread_.request_stop();
}

void WorkerThread::post(std::function<void()> job) {
  wait();
  if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& s) { work(s); });
  {
    const std::lock_guard lock(mutex_);
    job_ = std::move(job);
  }
  changed_.notify_all();
}

void WorkerThread::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !job_; });
  if (failure_) std::rethrow_exception(failure_);
}

void WorkerThread::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return static_cast<bool>(job_); })) {
    lock.unlock();
    std::exception_ptr failure;
    try {
      job_();
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    failure_ = failure;
    job_ = nullptr;
    changed_.notify_all();
  }
}

unsigned thread_count(unsigned wanted) {
  static const unsigned kCores = std::max(1U, std::thread::hardware_concurrency());  // reads files
  return wanted != 0 ? wanted : kCores;
}

void for_each_index(std::size_t count, unsigned threads,
                    const std::function<void(std::size_t)>& do_item) {
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) do_item(i);
    } catch (...) {
      next = count;
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t t = 1; t < std::min<std::size_t>(threads, count); ++t) {
      others.emplace_back(work);
    }
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace servomill::sim::system
