#include "sim/sweep/run_sweep.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "sim/model/scenario.h"
#include "sim/preparation/estimate.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/run/point_batch.h"
#include "sim/sweep/selection.h"
#include "sim/sweep/sweep.h"
#include "sim/system/worker_thread.h"

namespace servomill::sim::sweep {
namespace {

constexpr auto kProgressPeriod = std::chrono::milliseconds(20);  // an interrupt waits for it, too
constexpr std::size_t kBatchesPerThread = 4;  // at least, so that threads end together
constexpr std::size_t kWaitingPerThread = 2;  // batches that may wait to be written

// Hands out batches of neighbours among the points that are to be run.
class WorkQueue {
 public:
  WorkQueue(const Selection& selection, const std::vector<bool>& done)
      : selection_(selection), done_(done) {}

  std::uint64_t count() const {
    return selection_.size() -
           static_cast<std::uint64_t>(std::count(done_.begin(), done_.end(), true));
  }
  std::vector<std::uint64_t> next(std::size_t most) {
    const std::scoped_lock lock(mutex_);
    std::vector<std::uint64_t> points;
    for (; place_ < selection_.size() && points.size() < most; ++place_) {
      if (!done_.empty() && done_[place_]) continue;
      points.push_back(selection_.point(place_));
    }
    return points;
  }

 private:
  const Selection& selection_;
  const std::vector<bool>& done_;
  std::mutex mutex_;
  std::uint64_t place_ = 0;
};

// Batches on their way from the threads that run them to the one that takes the results.
class Results {
 public:
  explicit Results(std::size_t most) : most_(most) {}

  void put(std::vector<SweepPoint> batch) {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [&] { return waiting_.size() < most_ || closed_; });
    waiting_.push_back(std::move(batch));
    news_.notify_one();
  }
  // Nothing, if there was none within some time.
  std::optional<std::vector<SweepPoint>> take(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex_);
    if (!news_.wait_for(lock, patience, [&] { return !waiting_.empty(); })) return std::nullopt;
    std::vector<SweepPoint> batch = std::move(waiting_.front());
    waiting_.pop_front();
    room_.notify_one();
    return batch;
  }
  // Nobody takes any more: whoever waits for room goes on.
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    room_.notify_all();
  }

 private:
  std::size_t most_;
  std::mutex mutex_;
  std::condition_variable room_, news_;
  std::deque<std::vector<SweepPoint>> waiting_;
  bool closed_ = false;
};

bool same_question(const evaluation::ComparisonRow& a, const evaluation::ComparisonRow& b) {
  return a.case_name == b.case_name && a.quantity == b.quantity && a.axis == b.axis &&
         a.statistic == b.statistic && a.sections == b.sections && a.unit == b.unit;
}

// The points of one batch that can be read, and what they run.
struct ReadPoints {
  std::vector<SweepPoint> points;
  std::vector<model::Scenario> scenarios;
};

// Reads the points of one batch; those that are refused are results at once.
ReadPoints read_points(const Sweep& sweep, const std::vector<std::uint64_t>& points,
                       Results& results) {
  ReadPoints read;
  std::vector<SweepPoint> refused;
  for (const std::uint64_t point : points) {
    SweepPoint one{point, sweep.design().point(point), {}};
    try {
      read.scenarios.push_back(sweep.at(point));
      read.points.push_back(std::move(one));
      continue;
    } catch (const InputError& error) {
      one.result = {run::PointStatus::refused, run::in_one_line(error), {}};
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception& error) {
      one.result = {run::PointStatus::failed, error.what(), {}};
    }
    refused.push_back(std::move(one));
  }
  if (!refused.empty()) results.put(std::move(refused));
  return read;
}

// Runs the points of one batch together.
void run_points(const Sweep& sweep, const std::vector<std::uint64_t>& points,
                const engine::StopFlag& stop, std::atomic<float>& progress,
                const run::BatchControl& control, Results& results) {
  ReadPoints read = read_points(sweep, points, results);
  const std::vector<evaluation::ComparisonRow> wanted = sweep.quantities();
  const auto put = [&](std::vector<run::EndedPoint>&& batch) {
    std::vector<SweepPoint> ended;
    for (run::EndedPoint& one : batch) {
      const auto& rows = one.result.rows;
      if (!rows.empty() &&
          !std::equal(wanted.begin(), wanted.end(), rows.begin(), rows.end(), same_question)) {
        one.result = {run::PointStatus::refused,
                      "has other quantities or cases than the scenario without its sweep",
                      {}};
      }
      ended.push_back(std::move(read.points[one.place]));
      ended.back().result = std::move(one.result);
    }
    results.put(std::move(ended));
  };
  run::run_batch(read.scenarios, stop, progress, put, control);
}

const engine::StopFlag kNever = false;

// Threads that run batches, and the calling one, which takes their results.
class SweepRun {
 public:
  SweepRun(const Sweep& sweep, const Selection& selection, const std::vector<bool>& done,
           const SweepControl& control)
      : sweep_(sweep),
        control_(control),
        stop_(control.stop != nullptr ? *control.stop : kNever),
        queue_(selection, done),
        count_(queue_.count()),
        threads_(static_cast<unsigned>(std::clamp<std::uint64_t>(
            system::thread_count(control.threads), 1, std::max<std::uint64_t>(count_, 1)))),
        batch_(std::clamp<std::size_t>(count_ / (kBatchesPerThread * threads_), 1, control.batch)),
        batch_control_{control.keep, &cache_, run::rows_at_once(threads_)},
        // signals are large: those of few points wait
        results_(control.keep == run::Keep::series ? 1 : kWaitingPerThread * threads_),
        shares_(threads_),
        running_(threads_),
        failures_(threads_) {}

  void run() {
    std::vector<std::jthread> pool;
    {
      const StopGuard guard{given_up_, results_};
      for (std::size_t t = 0; t < threads_; ++t) pool.emplace_back([this, t] { work(t); });
      take_results();
    }
    pool.clear();
    for (const std::exception_ptr& failure : failures_) {
      if (failure) std::rethrow_exception(failure);
    }
  }

 private:
  // Should the results not be writable, no further batch begins.
  struct StopGuard {
    std::atomic<bool>& given_up;
    Results& results;
    ~StopGuard() {
      given_up = true;
      results.close();
    }
  };

  void work(std::size_t thread) {
    try {
      while (!stop_ && !given_up_) {
        const std::vector<std::uint64_t> points = queue_.next(batch_);
        if (points.empty()) break;
        run_points(sweep_, points, stop_, shares_[thread], batch_control_, results_);
        shares_[thread] = 0.0F;
        ended_ += points.size();
      }
    } catch (const Interrupted&) {
      given_up_ = true;  // points that have ended are results
    } catch (...) {
      failures_[thread] = std::current_exception();
    }
    --running_;
  }

  void take_results() {
    Stage stage("points", static_cast<double>(count_));
    for (bool last = false; !last;) {
      last = running_ == 0;  // all results of threads that ended have been put by now
      while (auto points = results_.take(last ? std::chrono::milliseconds(0) : kProgressPeriod)) {
        if (control_.batch_done) control_.batch_done(std::move(*points));
        stage.reach(points_done());
      }
      stage.reach(points_done());
    }
  }

  // Points in work count as far as they are.
  double points_done() const {
    double points = static_cast<double>(ended_);
    for (const auto& share : shares_) points += static_cast<double>(batch_) * share;
    return points;
  }

  const Sweep& sweep_;
  const SweepControl& control_;
  const engine::StopFlag& stop_;
  WorkQueue queue_;
  std::uint64_t count_;
  unsigned threads_;
  std::size_t batch_;
  preparation::PreparationCache cache_;
  run::BatchControl batch_control_;
  Results results_;
  std::vector<std::atomic<float>> shares_;  // of the batches in work
  std::atomic<std::uint64_t> ended_ = 0;    // points of batches that ended
  std::atomic<unsigned> running_;
  std::atomic<bool> given_up_ = false;
  std::vector<std::exception_ptr> failures_;
};

}  // namespace

void run_sweep(const Sweep& sweep, const Selection& selection, const std::vector<bool>& done,
               const SweepControl& control) {
  SweepRun(sweep, selection, done, control).run();
}

}  // namespace servomill::sim::sweep
