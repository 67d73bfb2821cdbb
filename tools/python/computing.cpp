#include "tools/python/computing.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/user_file.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

constexpr auto kLookPeriod = std::chrono::milliseconds(50);

std::timed_mutex busy;
thread_local int inside = 0;

void refuse_nested() {
  if (inside == 0) return;
  throw std::runtime_error(
      "a strategy or a progress function cannot begin a computation of servomill");
}

// Waits for the end of another computation, without the GIL but for Ctrl-C.
std::unique_lock<std::timed_mutex> turn() {
  std::unique_lock<std::timed_mutex> lock(busy, std::defer_lock);
  while (true) {
    {
      const py::gil_scoped_release released;
      if (lock.try_lock_for(kLookPeriod)) return lock;
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

// Work on a thread of its own.
class Working {
 public:
  explicit Working(const std::function<void()>& work) : thread_([this, &work] { run(work); }) {}
  Working(const Working&) = delete;
  Working& operator=(const Working&) = delete;
  ~Working() { join(); }

  // True if it has ended before the next look.
  bool wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    return ended_.wait_for(lock, kLookPeriod, [&] { return has_ended_; });
  }
  void join() {
    if (thread_.joinable()) thread_.join();
  }
  // Done, 0 to 1; between two stages as before.
  double share() {
    const std::scoped_lock lock(mutex_);
    const auto stages = watch_ != nullptr ? watch_->stages() : std::vector<StageState>();
    if (!stages.empty()) share_ = share_done(stages);
    return share_;
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void run(const std::function<void()>& work) {
    const ProgressWatch watch;
    watched_by(&watch);
    try {
      work();
    } catch (...) {
      failure_ = std::current_exception();
    }
    watched_by(nullptr);
    const std::scoped_lock lock(mutex_);
    has_ended_ = true;
    ended_.notify_one();
  }

  void watched_by(const ProgressWatch* watch) {
    const std::scoped_lock lock(mutex_);
    watch_ = watch;
  }

  std::mutex mutex_;
  const ProgressWatch* watch_ = nullptr;  // of the thread, while it works
  double share_ = 0.0;
  std::condition_variable ended_;
  bool has_ended_ = false;
  std::exception_ptr failure_;
  std::thread thread_;  // the last member: it uses the others
};

void look(const py::object& progress, double share) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  if (progress.is_none()) return;
  const InsideComputation mark;
  progress(share);
}

}  // namespace

InsideComputation::InsideComputation() { ++inside; }
InsideComputation::~InsideComputation() { --inside; }

void compute(const py::object& progress, const std::function<void()>& work) {
  refuse_nested();
  const std::unique_lock<std::timed_mutex> lock = turn();
  const InputRecord inputs;
  interrupt_wanted = false;
  std::exception_ptr raised;
  {
    const py::gil_scoped_release released;
    Working working(work);
    while (!working.wait()) {
      if (raised) continue;
      const py::gil_scoped_acquire acquired;
      try {
        look(progress, working.share());
      } catch (...) {
        raised = std::current_exception();
        interrupt_wanted = true;
      }
    }
    working.join();
    interrupt_wanted = false;
    if (!raised) working.rethrow();
  }
  if (raised) std::rethrow_exception(raised);
  look(progress, 1.0);
}

void while_idle(const std::function<void()>& change) {
  refuse_nested();
  const std::unique_lock<std::timed_mutex> lock(busy, std::try_to_lock);
  if (!lock) throw std::runtime_error("not while servomill computes in another thread");
  change();
}

}  // namespace servomill::python
