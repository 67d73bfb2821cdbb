/// Work beside the thread that asks for it.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace servomill::sim::system {

/// A thread of its own that does one job after the other, in the order in which they were given.
/// None waits in a queue, so that what jobs hold stays bounded. For one poster.
///
/// A job that throws is the last one: the next post() or wait() throws what it threw, those after
/// it do so too, and no further job is done.
class WorkerThread {
 public:
  WorkerThread() = default;
  /// Waits for the job that runs; what it throws is lost.
  ~WorkerThread();
  WorkerThread(const WorkerThread&) = delete;
  WorkerThread& operator=(const WorkerThread&) = delete;

  /// Waits until no job runs, then starts this one. The first post starts the thread.
  void post(std::function<void()> job);
  /// Waits until no job runs.
  void wait();

 private:
  void work(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::function<void()> job_;  // empty: none
  std::exception_ptr failure_;
  std::jthread thread_;  // last: it uses the others
};

/// Number of threads for a wish: 0 is one a core.
unsigned thread_count(unsigned wanted);

/// Calls do_item(index) for 0 <= index < count on up to `threads` threads, this one among them.
/// @throws what one of the calls threw, when all threads have ended
void for_each_index(std::size_t count, unsigned threads,
                    const std::function<void(std::size_t)>& do_item);

}  // namespace servomill::sim::system
